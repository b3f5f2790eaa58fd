"""Laws of the largest connected piece."""

import numpy as np
import pytest

from kinetree.tasks.numerics.geometry.components import largest_component

TETRAHEDRON = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], float)
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]], np.int32)


@pytest.mark.parametrize("scale", [0.5, 3.0])
def test_piece_with_the_greatest_area_is_found_wherever_it_stands(scale: float) -> None:
    V = np.vstack([TETRAHEDRON, [[9, 9, 9]], TETRAHEDRON * scale + 5])
    vertex, F, share = largest_component(V, np.vstack([FACES, FACES + 5]))
    first = scale < 1
    assert vertex.tolist() == ([0, 1, 2, 3] if first else [5, 6, 7, 8])
    assert share == pytest.approx(1 / (1 + scale**2) if first else scale**2 / (1 + scale**2))
    assert np.array_equal(F, FACES)


def test_whole_surface_is_its_own_piece() -> None:
    vertex, F, share = largest_component(TETRAHEDRON, FACES)
    assert vertex.tolist() == [0, 1, 2, 3]
    assert np.array_equal(F, FACES)
    assert share == 1


def test_surface_without_area_has_a_piece_all_the_same() -> None:
    vertex, F, share = largest_component(np.zeros((4, 3)), FACES)
    assert len(vertex) == 4
    assert len(F) == 4
    assert share == 1
