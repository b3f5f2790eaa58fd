"""Contract of further_pose: one frame by itself, as the tree has it, fitted where uncertain."""

import numpy as np
from fitting import FIRST, arms, articulation, surface_at

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.further_pose import FurtherPose
from kinetree.tasks.structure.further_pose import further_pose

TREE = articulation(arms()[0])


def posed(row: int, lost: int = -1, certain: float = 1.0) -> FurtherPose:
    """A frame whose true pose the tree has in this row, one arm aligned wrongly where that is asked."""
    known, body = arms()
    surface = surface_at(known, body, row)
    mesh = Mesh(vertices=surface.V, faces=surface.F, vertex_of_input=np.arange(len(surface.V)), cleaning=Cleaning())
    confidence = np.where(known.label == lost, 0.05, certain)
    off = 0.02 * body.size * (known.label == lost)[:, None]
    aligned = Alignment(
        vertices=known.x[row] + off, residual=np.full(len(known.V), 0.01), stretch=np.ones(len(known.V)),
        confidence=confidence, uncovered=0.0,
    )  # fmt: skip
    return further_pose(TREE, {FIRST + 20: mesh}, {FIRST + 20: aligned})


def test_a_frame_like_one_that_was_learned_from_has_its_pose() -> None:
    found = posed(3)
    assert (found.frame, found.moved) == (FIRST + 20, False)
    np.testing.assert_allclose(found.positions, TREE.positions[3], atol=0.01)
    np.testing.assert_allclose(found.rotation, TREE.rotation[3], atol=1e-3)
    assert found.seen.all()
    assert found.confidence.min() > 0.9


def test_bones_keep_their_lengths() -> None:
    found = posed(11, lost=2)
    child, parent = np.arange(1, 5), np.array(TREE.parents[1:])
    length = np.linalg.norm(found.positions[child] - found.positions[parent], axis=1)
    np.testing.assert_allclose(length, TREE.lengths[1:], rtol=1e-9)


def test_an_uncertain_frame_is_fitted_to_its_surface() -> None:
    found = posed(11, lost=2)
    assert not found.seen[3]
    assert found.moved
    np.testing.assert_allclose(found.rotation[[0, 1, 4]], TREE.rotation[11][[0, 1, 4]], atol=0.05)
