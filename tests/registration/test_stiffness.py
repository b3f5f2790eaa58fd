"""Contract of the three stiffnesses: learned from all frames, in whatever order, and nothing for fixed connectivity."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.stiffness import first_stiffness, second_stiffness, third_stiffness


def test_stiffness_is_above_nothing_and_at_most_one_and_some_ties_bend() -> None:
    for name in ("first_stiffness", "second_stiffness", "third_stiffness"):
        s = getattr(walk(), name).stiffness
        assert len(s) == len(walk().template.ties)
        assert ((s > 0) & (s <= 1)).all()
        assert s.min() < 0.5 < s.max()


def test_order_of_frames_does_not_matter() -> None:
    made = walk()
    mixed = tuple(made.repair[t] for t in (3, 0, 4, 1, 2))
    assert np.array_equal(first_stiffness(made.template, mixed).stiffness, made.first_stiffness.stiffness)


def test_body_that_never_moves_is_stiff_everywhere() -> None:
    made = walk()
    rest = made.repair[made.reference.frame]
    assert np.allclose(first_stiffness(made.template, (rest, rest)).stiffness, 1.0)


def test_fixed_connectivity_has_nothing_to_learn() -> None:
    made = walk()
    empty = deformation_graph(made.reference.model_copy(update={"fixed": True}), DeformationGraphParams())
    assert len(second_stiffness(empty, tuple(made.untwisting.values()), made.twist).stiffness) == 0
    assert len(third_stiffness(empty, (), made.twist, made.pieces).stiffness) == 0
