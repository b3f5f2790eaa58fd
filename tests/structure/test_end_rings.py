"""Rings at ends of limbs as the task gives them."""

import numpy as np
from aligned_body import agreed, judged, tube

from kinetree.schemas.structure.end_rings import EndRings
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams
from kinetree.tasks.structure.first_tree import first_tree


def runs() -> tuple[EndRings, ...]:
    reference, parts, alignment, mesh, leaves = tube(0.99)
    first = first_tree(reference, parts, alignment, mesh, leaves, FirstTreeParams())
    return judged(agreed(first, reference, alignment, mesh, leaves), reference, alignment, mesh, leaves)


def test_runs_of_frames_together_are_all_frames_and_have_the_same_rings() -> None:
    laid = runs()
    assert np.concatenate([run.frame for run in laid]).tolist() == list(range(24))
    assert len({run.visible.shape[1] for run in laid}) == 1
    assert all(run.visible.all() and (run.two < run.one).mean() > 0.8 for run in laid)
