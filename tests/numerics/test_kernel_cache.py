"""Laws of compiled code on disk: whoever else writes, a key has its own data or none."""

import os
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kinetree.tasks.numerics import compiled as home
from kinetree.tasks.numerics import kernel_cache
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.kernel_cache import KernelCache, KernelFiles

TURNS = 50
"""Of two writers; with the index of numba 23 of 200 such turns came out wrong."""


def doubled(x: Any) -> Any:
    return 2 * x


@pytest.fixture
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path))
    monkeypatch.setattr(home, "_code_folder", home._code_folder.__wrapped__)
    return tmp_path


def test_two_that_save_at_once_never_get_the_data_of_the_other(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    together, dumps = threading.Barrier(2), kernel_cache.dumps
    monkeypatch.setattr(kernel_cache, "dumps", lambda value: (together.wait(timeout=60), dumps(value))[1])
    for turn in range(TURNS):
        folder = tmp_path / str(turn)
        folder.mkdir()
        writers = [threading.Thread(target=KernelFiles(folder, "f").save, args=(key, key)) for key in ("one", "other")]
        for writer in writers:
            writer.start()
        for writer in writers:
            writer.join()
        assert [KernelFiles(folder, "f").load(key) for key in ("one", "other")] == ["one", "other"]


def test_a_file_that_holds_another_key_or_is_short_is_none(tmp_path: Path) -> None:
    files = KernelFiles(tmp_path, "f")
    files.save("key", "data")
    (path,) = tmp_path.iterdir()
    path.rename(files._path("other"))
    assert files.load("other") is None
    files.save("key", "data")
    whole = path.read_bytes()
    for size in (0, 10, len(whole) - 1):
        path.write_bytes(whole[:size])
        assert files.load("key") is None
    files.flush()
    assert not list(tmp_path.iterdir())


def test_what_a_killed_writer_left_goes_and_what_is_being_written_stays(own_folder: Path) -> None:
    compiled(doubled)(3)  # type: ignore[operator]
    (kernel,) = (path for path in own_folder.rglob("*") if path.is_file())
    kill = "os.kill(os.getpid(), signal.SIGKILL)"
    script = (
        "import os, signal\nfrom pathlib import Path\nfrom kinetree.tasks.numerics.kernel_cache import KernelFiles\n"
        f"Path.replace = lambda *_: {kill}\nKernelFiles(Path({str(kernel.parent)!r}), 'f').save('key', 'data')"
    )
    for _ in range(2):
        subprocess.run([sys.executable, "-P", "-c", script], check=False)
    left, writing = set(kernel.parent.iterdir()) - {kernel}
    os.utime(left, (1, 1))
    compiled(doubled)
    assert set(kernel.parent.iterdir()) == {kernel, writing}


def test_every_compiled_function_has_a_file_for_each_of_its_types(own_folder: Path) -> None:
    function: Any = compiled(doubled)
    assert isinstance(function._cache, KernelCache)
    assert [function(3), function(1.5), function(np.ones(2)).sum()] == [6, 3.0, 4.0]
    assert len([path for path in own_folder.rglob("*") if path.is_file()]) == 3
    again: Any = compiled(doubled)
    assert [again(3), again(1.5), again(np.ones(2)).sum()] == [6, 3.0, 4.0]
    assert sum(again.stats.cache_hits.values()) == 3


def test_another_process_finds_what_one_has_compiled(own_folder: Path) -> None:
    ask = "from kinetree.tasks.numerics.kernel_list import lines, compile_all; print(compile_all(lines()[:1], lambda: True))"

    def files_after_a_run() -> dict[str, int]:
        subprocess.run([sys.executable, "-P", "-c", ask], check=True, capture_output=True)
        return {str(path): path.stat().st_mtime_ns for path in own_folder.rglob("*") if path.is_file()}

    first = files_after_a_run()
    assert first
    assert files_after_a_run() == first


def test_a_disk_that_is_full_keeps_nothing_and_fails_no_call(own_folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    function: Any = compiled(doubled)

    def full(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(KernelFiles, "save", full)
    assert function(3) == 6
