"""Parts lie on the frames' own surfaces, from wherever they were aligned."""

import numpy as np
from smeared import Frames, three_parts, turning

from kinetree.tasks.numerics.structure.first_tree import in_tree_order
from kinetree.tasks.numerics.structure.laid_parts import LaidParts, LaidPartsSettings, laid_frames, laid_parts
from kinetree.tasks.numerics.structure.part_tree import MovingSurface


def laid(off: float = 0.0) -> tuple[MovingSurface, np.ndarray, LaidParts]:
    """The body, its labels, and its parts as they lie where they were aligned so much off, share of the body."""
    body, found = three_parts()
    tree = in_tree_order(found._replace(t=found.t + np.array([off, 0.0, 0.0]) * body.size), 3)
    surface = Frames(turning()).prepared(body.size)
    return body, tree.label, laid_parts(body.V, body.F, body.area, tree, {f: surface(f) for f in range(24)})


def test_parts_lie_where_the_frames_have_them_and_not_where_they_were_aligned() -> None:
    body, label, found = laid(0.02)
    true = Frames(turning()).true
    assert found.joint.tolist() == [0, 1, 2]
    middle = np.stack([body.V[label == part].mean(axis=0) for part in found.joint])
    there = np.einsum("flxy,ly->flx", found.rotation, middle) + found.translation
    want = np.einsum("flxy,ly->flx", true.R, middle) + true.t
    # a tube is free to slide along itself
    assert np.median(np.linalg.norm(there - want, axis=2)) < 0.01 * body.size
    assert (found.square < (0.002 * body.size) ** 2).all()


def test_stiffness_is_that_of_a_turn_and_a_shift() -> None:
    _, _, found = laid()
    assert found.stiffness.shape == (24, 3, 6, 6)
    np.testing.assert_allclose(found.stiffness, found.stiffness.swapaxes(2, 3), atol=1e-9)
    assert (np.linalg.eigvalsh(found.stiffness) > -1e-9).all()


def test_of_many_frames_some_are_looked_at_and_of_few_none() -> None:
    some = laid_frames(100, LaidPartsSettings(most_frames=12))
    assert (len(some), some[0], some[-1]) == (12, 0, 99)
    assert laid_frames(8).tolist() == list(range(8))
    assert len(laid_frames(7)) == 0
