"""Where a limb may be that surface calls for."""

import numpy as np
from fitting import FRAMES, arms, surface_at, tip, true, turned
from limbs import rotation

from kinetree.tasks.numerics.structure.articulated_frame import FramePose, relative_rotations
from kinetree.tasks.numerics.structure.pose_hypotheses import pose_hypothesis
from kinetree.tasks.numerics.structure.surface_matches import searched

AWAY = rotation((0.0, 0.0, 1.0), 2.1)
"""An arm on the next arm."""


def chosen(start_away: bool) -> tuple[FramePose | None, FramePose, float]:
    known, body = arms()
    frame, at = 5, true(known, 5)
    start = turned(at, 1, AWAY) if start_away else at
    target = surface_at(known, body, frame)
    is_known = np.ones((FRAMES, 4), bool)
    is_known[frame, 1] = False
    unseen = np.array([False, True, False, False])
    turn = relative_rotations(known.R, body.parents)
    found = pose_hypothesis(body, start, target, searched(body, start, target), turn, is_known, frame, unseen)
    off = np.linalg.norm(tip(body, found or start, 1) - tip(body, at, 1)) / body.size
    return found, start, float(off)


def test_arm_on_the_wrong_arm_is_guessed_from_other_frames() -> None:
    found, start, off = chosen(True)
    assert found is not None
    assert off < 0.1
    assert np.array_equal(found.R[[0, 2, 3]], start.R[[0, 2, 3]])


def test_where_nothing_is_left_over_nothing_is_guessed() -> None:
    assert chosen(False)[0] is None
