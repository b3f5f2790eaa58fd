"""Laws of frames that are begun with the poses of alike ones: which are alike, which may be wrong, and what is better."""

import numpy as np
import pytest
from limbs import reaching_body, rotation, twisted
from shipped import FITTING, GRAPH

from kinetree.tasks.numerics.registration.alike_poses import AlikePosesSettings, alike_frames, entry, looked_through
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, at_rest, bending, shape
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph
from kinetree.tasks.numerics.registration.near_pose import near_pose, thinned_body, thinned_frame
from kinetree.tasks.numerics.registration.recovery import recovery
from kinetree.tasks.numerics.registration.take_entries import Limbs

SURFACE, FACES, STEMS = reaching_body()
BODY = deformation_graph(SURFACE, FACES, GRAPH._replace(nodes=150))
TWIST, AWAY, ELSEWHERE = 0.6, np.array([20.0, -10.0, 5.0]), rotation((0, 0, 1), 2.4)


def stands(points, angle, R=None):
    """Points of the body whose trunk is twisted; with R it stands elsewhere and faces another way."""
    there = twisted(points, angle)
    return there if R is None else there @ R.T + AWAY


def limbs(angle, R=None, count=4):
    """What a frame shows of its limbs, in an order of its own."""
    return Limbs(stands(STEMS, angle, R)[[2, 0, 3, 1]][:count], stands(SURFACE, angle, R).mean(axis=0), BODY.size)


def right(angle, R=None):
    """The pose of the twisted body."""
    turn = angle * np.clip((BODY.g[:, 2] + 3.0) / 5.0, 0.0, 1.0)
    own = np.stack([rotation((0, 0, 1), one) for one in turn])
    return Pose(own if R is None else R @ own, stands(BODY.g, angle, R))


def off(pose):
    """How far the body lies at most from where it is in the frame, share of its size."""
    return float(np.linalg.norm(shape(BODY, pose)[0] - stands(SURFACE, TWIST), axis=1).max()) / BODY.size


@pytest.fixture(scope="module")
def exchanged():
    """A pose that covers the twisted body with its legs exchanged: both turned by half a turn about the trunk's axis."""
    own, is_leg = right(TWIST), BODY.g[:, 2] < -4.0
    half = np.where(is_leg[:, None, None], np.diag([-1.0, -1.0, 1.0]), np.eye(3))
    start = Pose(half @ own.rotation, np.einsum("nxy,ny->nx", half, own.translation))
    near = near_pose(thinned_body(BODY), start, thinned_frame(stands(SURFACE, TWIST), FACES, BODY.size))
    assert near.distant < 0.003
    assert off(near.pose) > 0.2
    assert bending(BODY, near.pose) > 2.0 * bending(BODY, right(TWIST))
    return near.pose


def test_frames_are_alike_wherever_the_body_stands_and_in_whatever_order_it_shows_its_limbs():
    seen = [limbs(0.0), limbs(0.8), limbs(0.7, ELSEWHERE), limbs(0.1, ELSEWHERE), limbs(0.0, count=3)]
    found = alike_frames(seen, AlikePosesSettings(looked_at=1))
    assert [row.tolist() for row in found] == [[3], [2], [1], [0], []]
    every = alike_frames(seen)
    assert [row.tolist() for row in every[:2]] == [[3, 2, 1], [2, 3, 0]]
    assert alike_frames([limbs(0.0), limbs(0.0)._replace(stems=STEMS[:0])])[0].tolist() == []


def test_frames_that_bend_farther_than_alike_ones_are_looked_through_and_failed_ones_always():
    alike = [np.array(row) for row in ([1, 2], [0, 2], [0, 1], [4], [0, 5], [0])]
    bends, failed = np.array([1.0, 1.2, 2.0, 9.0, 0.5, 0.4]), np.array([False, False, False, True, True, True])
    found = [(at, others.tolist()) for at, others in looked_through(bends, alike, failed, 0.3)]
    assert found == [(2, [0, 1]), (4, [0]), (5, [0])]
    assert looked_through(bends, alike, np.zeros(6, np.bool_), 9.0) == []


def test_a_frame_with_its_legs_exchanged_has_the_pose_of_an_alike_frame(exchanged):
    poses, seen = [exchanged, right(0.7, ELSEWHERE), at_rest(BODY)], [limbs(TWIST), limbs(0.7, ELSEWHERE), limbs(0.0)]
    frame, cloud = Target.of(stands(SURFACE, TWIST), FACES, BODY.size), thinned_body(BODY)

    def begun(own, others, settings=None):
        return entry(cloud, own, frame, seen, 0, np.array(others), poses.__getitem__, settings)

    assert off(begun(exchanged, [1, 2])) < 0.1
    assert begun(right(TWIST), [1, 2]) is None
    assert begun(exchanged, [1], AlikePosesSettings(apart=1e-4)) is None
    assert begun(exchanged, [1], AlikePosesSettings(less=0.0)) is None
    assert begun(exchanged, []) is None


def test_a_frame_that_is_not_covered_has_the_pose_of_an_alike_frame_that_bends_farther():
    lost = Pose(at_rest(BODY).rotation, BODY.g + AWAY)
    poses, seen = [lost, right(0.7, ELSEWHERE)], [limbs(TWIST), limbs(0.7, ELSEWHERE)]
    frame = Target.of(stands(SURFACE, TWIST), FACES, BODY.size)
    assert off(entry(thinned_body(BODY), lost, frame, seen, 0, np.array([1]), poses.__getitem__, failed=True)) < 0.1


@pytest.mark.parametrize(("uncovered", "failed"), [(0.001, []), (0.3, [2])])
def test_recovery_puts_exchanged_legs_right_by_an_alike_frame(exchanged, uncovered, failed):
    poses, seen = [at_rest(BODY), right(0.7, ELSEWHERE), exchanged], [limbs(0.0), limbs(0.7, ELSEWHERE), limbs(TWIST)]
    there = [stands(SURFACE, angle, R) for angle, R in ((0.0, None), (0.7, ELSEWHERE), (TWIST, None))]
    target = [Target.of(V, FACES, BODY.size) for V in there].__getitem__
    share = np.array([0.0, 0.001, uncovered])
    found = recovery(BODY, share, poses.__getitem__, target, 0, FITTING, takes=[(slice(0, 3), 0)], seen=seen)
    assert np.flatnonzero(found.failed).tolist() == failed
    assert list(found.recovered) == [2]
    assert off(found.recovered[2].pose) < 0.1
    assert found.recovered[2].uncovered < 0.004


def test_recovery_leaves_the_reference_and_what_is_right(exchanged):
    seen = [limbs(TWIST), limbs(0.7, ELSEWHERE)]
    there = [stands(SURFACE, TWIST), stands(SURFACE, 0.7, ELSEWHERE)]
    target = [Target.of(V, FACES, BODY.size) for V in there].__getitem__
    for own, reference in ((exchanged, 0), (right(TWIST), 1)):
        poses = [own, right(0.7, ELSEWHERE)]
        assert not recovery(BODY, np.zeros(2), poses.__getitem__, target, reference, FITTING, seen=seen).recovered
