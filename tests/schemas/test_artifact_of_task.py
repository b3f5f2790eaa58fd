"""The types of artifacts by name are those of the tasks that there are."""

import runpy
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def test_every_name_of_a_task_has_the_type_that_the_task_writes() -> None:
    written = (ROOT / "schemas" / "artifact_of_task.pyi").read_text(encoding="utf-8")
    stub = runpy.run_path(str(ROOT / ".ci" / "artifact_of_task.py"))["stub"]
    assert written == stub(), "schemas/artifact_of_task.pyi is stale; make artifact-types writes it anew"
