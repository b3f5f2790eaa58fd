"""Laws of lost limbs: everything beyond the joint goes, the rest stays, and what cannot be lost is refused."""

import numpy as np
import pytest

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.losses import Dropped

FORK = Figure.of(
    {
        "name": "fork",
        "joints": [
            {"name": "handle", "position": [0, 0, 0], "radius": 1},
            {"name": "neck", "parent": "handle", "position": [0, 0, 5], "radius": 1},
            {"name": "left", "parent": "neck", "position": [-3, 0, 9], "radius": 0.6},
            {"name": "right", "parent": "neck", "position": [3, 0, 9], "radius": 0.6},
            {"name": "tip", "parent": "right", "position": [3, 0, 13], "radius": 0.5},
        ],
        "motions": {"still": {}},
    }
)
FLESH = Flesh.of(FORK)


def lost(**row):
    return Dropped.of(FORK, FLESH, {"limb": "right", "begin": 1, "end": 2, **row}, frames=4)


def test_what_lies_beyond_the_joint_is_lost_and_nothing_else():
    carried = np.array([FORK.names[p] for p in FLESH.parent])
    assert set(carried[lost().limbs]) == {"right"}
    assert {"handle", "neck"} <= set(carried[~lost().limbs])


@pytest.mark.parametrize(
    ("row", "words"),
    [({"limb": "rihgt"}, "right"), ({"end": 9}, "4"), ({"begin": 3, "end": 1}, "begin"), ({"limb": "handle"}, "handle")],
)
def test_what_cannot_be_lost_is_refused(row, words):
    with pytest.raises(FigureError, match=words):
        lost(**row)


def test_row_with_other_keys_is_refused():
    with pytest.raises(FigureError, match="exactly limb, begin and end"):
        lost(until=3)
