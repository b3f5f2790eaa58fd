"""Laws of kept compiled code: it is found again by the same code and by no other."""

import subprocess
import sys
from pathlib import Path

import pytest

from kinetree.tasks.numerics import compiled as home
from kinetree.tasks.numerics.compiled import compiled

INNER = "from kinetree.tasks.numerics.compiled import compiled\n\n@compiled\ndef inner(x):\n    return x + {number}\n"
OUTER = (
    "from kinetree.tasks.numerics.compiled import compiled\n"
    "from kinetree.tasks.numerics.zz_inner import inner\n\n"
    "@compiled\ndef outer(x):\n    return inner(x)\n"
)
ASK = "import sys; sys.path.insert(0, {folder!r}); import kinetree.tasks.numerics as n; n.__path__.append({folder!r})\n"
ASK += "from kinetree.tasks.numerics.zz_outer import outer; print(outer(1), sum(outer.stats.cache_hits.values()))"


@compiled
def doubled(x: float) -> float:
    return 2 * x


def test_compiled_function_computes_what_the_function_does() -> None:
    assert doubled(21.0) == doubled.py_func(21.0) == 42.0  # type: ignore[attr-defined]


def test_edit_in_a_called_file_is_noticed_and_unchanged_code_is_found_again(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))
    (tmp_path / "zz_outer.py").write_text(OUTER)

    def asked(number: int) -> str:
        (tmp_path / "zz_inner.py").write_text(INNER.format(number=number))
        command = [sys.executable, "-B", "-c", ASK.format(folder=str(tmp_path))]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    assert asked(1) == "2 0"
    assert asked(1) == "2 1"
    assert asked(2) == "3 0"


def test_a_copy_elsewhere_finds_the_same_compiled_code(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(tmp_path / "kept"))

    def asked(folder: str) -> str:
        place = tmp_path / folder
        place.mkdir()
        (place / "zz_inner.py").write_text(INNER.format(number=1))
        (place / "zz_outer.py").write_text(OUTER)
        command = [sys.executable, "-B", "-c", ASK.format(folder=str(place))]
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()

    assert asked("one") == "2 0"
    assert asked("other") == "2 1"


def test_folder_that_cannot_be_written_means_no_keeping_and_no_failure(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("NUMBA_CACHE_DIR", str(blocked))
    home._code_folder.cache_clear()
    try:
        assert compiled(lambda x: x - 1)(3) == 2
    finally:
        home._code_folder.cache_clear()
