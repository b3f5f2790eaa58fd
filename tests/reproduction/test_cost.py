"""Table 1: every task is counted in one step of the method, and the paper's figures are those it prints."""

import pytest

from kinetree.tasks.methods import METHODS
from kinetree.tasks.reproduction.cost import STEP_OF_SHELF, step
from kinetree.tasks.reproduction.printed import TABLE_1


@pytest.mark.parametrize(
    ("task", "expected"),
    [
        ("mesh", "not counted"),
        ("geodesics", "macroscopic"),
        ("leaves", "macroscopic"),
        ("tracking", "microscopic"),
        ("refit", "microscopic"),
        ("arap", "microscopic"),
        ("geodesic_mapping", "microscopic"),
        ("annuli", "mesoscopic"),
        ("kinematic_structure", "mesoscopic"),
        ("rigid_parts", "mesoscopic"),
        ("evaluation", "not counted"),
    ],
)
def test_step_of_a_task_is_that_of_the_paper(task: str, expected: str) -> None:
    known = {one.name: one for name in ("mesoscopic", "mesoscopic-2014") for one in METHODS[name].tasks}
    assert step(known[task]) == expected


@pytest.mark.parametrize("method", ["mesoscopic", "mesoscopic-2014"])
def test_every_task_of_the_method_has_a_step_and_every_step_a_task(method: str) -> None:
    assert {step(task) for task in METHODS[method].tasks} == set(STEP_OF_SHELF.values())


@pytest.mark.parametrize("row", TABLE_1, ids=lambda row: row.sequence)
def test_printed_steps_sum_to_the_printed_total(row) -> None:
    assert row.macroscopic + row.microscopic + row.mesoscopic == pytest.approx(row.total, rel=2e-3)
