"""Contract of take_entries: none for one take, and source frame numbers for several."""

from typing import Any

import numpy as np
from stepwise import walk

from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.input.frame_numbers import TAKE
from kinetree.tasks.registration.take_entries import take_entries


def shifted_tips(shift: float) -> Extrema:
    stems = np.array([[[0, 0, 0], [1, 0, 0]], [[0, 0, 0], [0, 2, 0]], [[0, 0, 0], [0, 0, -3]]], float) + shift
    return Extrema(
        vertices=np.zeros(3, int), persistence=np.full(3, 0.5), stems=stems, normals=np.zeros((3, 3)), value=np.full(3, 0.7),
        peaks=np.full(3, 0.5), loops=np.zeros(0), size=1.0, centre=(shift,) * 3, euler=2, components=1,
    )  # fmt: skip


def entries_of(*frames: int) -> Any:
    reference = walk().reference.model_copy(update={"frames": frames, "frame": frames[0]})
    return take_entries({t: shifted_tips(float(t % TAKE)) for t in frames}, reference)


def test_one_take_has_no_entries() -> None:
    assert entries_of(4, 5, 6).frames == ()


def test_another_take_has_one_by_its_number() -> None:
    found = entries_of(4, 5, TAKE + 9, TAKE + 10)
    assert (found.before, found.frames) == ((4,), (TAKE + 9,))
    np.testing.assert_allclose(found.rotation, [np.eye(3)], atol=1e-9)
    np.testing.assert_allclose(found.shift, [[5.0] * 3])
