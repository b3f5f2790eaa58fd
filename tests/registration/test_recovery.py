"""Contract of repair: what was tracked well passes through, what was lost comes back from the other side."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.tracking import Tracking
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.registration.pose import graph, pose
from kinetree.tasks.registration.recovery import recovery


def lost(tracked: Tracking, shift: float, uncovered: float) -> Tracking:
    moved = np.array(tracked.translation) + shift
    return tracked.model_copy(update={"translation": moved, "uncovered": uncovered})


def test_frame_that_is_no_suspect_keeps_its_pose_bit_for_bit() -> None:
    made = walk()
    for t, here in made.tracking.items():
        assert not made.suspects.suspect[t]
        assert not made.repair[t].repaired
        assert np.array_equal(made.repair[t].rotation, here.rotation)
        assert np.array_equal(made.repair[t].translation, here.translation)
        assert (made.repair[t].steps, made.repair[t].uncovered) == (here.steps, here.uncovered)


def test_lost_frame_is_found_again_from_the_frame_beyond_it() -> None:
    made = walk()
    body, gone = graph(made.template), lost(made.tracking[3], 0.5 * made.reference.size, 0.9)
    found = recovery(made.mesh[3], made.template, gone, made.suspects, made.repair[4])
    assert found.repaired
    assert found.uncovered < 0.02
    error = shape(body, pose(found))[0] - shape(body, pose(made.tracking[3]))[0]
    assert np.linalg.norm(error, axis=1).mean() < 0.01 * made.reference.size


def test_lost_frame_beyond_is_no_help() -> None:
    made = walk()
    gone = lost(made.tracking[3], 0.5 * made.reference.size, 0.5)
    worse: Recovery = made.repair[4].model_copy(update={"uncovered": 0.9})
    kept = recovery(made.mesh[3], made.template, gone, made.suspects, worse)
    assert not kept.repaired
    assert np.array_equal(kept.translation, gone.translation)


def test_second_try_that_covers_less_is_not_taken() -> None:
    made = walk()
    better = made.tracking[3].model_copy(update={"uncovered": 1e-9})
    told: Recovery = made.repair[4].model_copy(update={"uncovered": 0.0})
    assert not recovery(made.mesh[3], made.template, better, made.suspects, told).repaired
