"""Results of the default method are the same bytes wherever they are computed: the cheapest cells of benchmarks/equality.py."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from kinetree.pipeline import Pipeline

UNTIL = ("skeleton", "projection")
"""Everything but pictures and files, which take longer than the rest."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def pipeline(folder: Path, **compute: object) -> Pipeline:
    synth = {"figure": "quadruped", "frames": 3, "vertices": 250}
    return Pipeline.of({"output": str(folder), "source": {"synth": synth}, "compute": compute})


def artifacts(there: Pipeline) -> dict[str, str | None]:
    plan = there.plan(until=UNTIL)
    assert plan.is_done
    return {node.node: node.artifact for node in plan.nodes}


@pytest.fixture(scope="module")
def expected(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str | None]:
    """What one thread of this process makes."""
    there = pipeline(tmp_path_factory.mktemp("sync"), executor="sync")
    assert there.run(until=UNTIL)["status"] == "done"
    return artifacts(there)


def test_threads_make_the_same_bytes(expected: dict[str, str | None], tmp_path: Path) -> None:
    there = pipeline(tmp_path, executor="threads", workers=3)
    assert there.run(until=UNTIL)["nodes"]["ran"] > 50
    assert artifacts(there) == expected


def test_worker_process_with_other_numbers_of_threads_makes_the_same_bytes(
    expected: dict[str, str | None], tmp_path: Path
) -> None:
    there = pipeline(tmp_path, executor="processes", workers=1)
    (tmp_path / "run.yaml").write_text(str(there.config.saved() | {"compute": {"executor": "processes", "workers": 1}}))
    environment = {name: value for name, value in os.environ.items() if name not in THREADS}
    command = [str(Path(sys.executable).parent / "kinetree"), "run", str(tmp_path / "run.yaml"), "--quiet"]
    until = [word for name in UNTIL for word in ("--until", name)]
    subprocess.run([*command, *until], env=environment | {"OMP_NUM_THREADS": "2"}, check=True)
    assert artifacts(there) == expected
