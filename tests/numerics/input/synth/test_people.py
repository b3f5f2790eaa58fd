"""Laws of people drawn from a seed: closed surfaces, limbs apart, unequal sides, and motions that any frame rate samples."""

from importlib.resources import files

import numpy as np
import pytest
import trimesh
import yaml
from scipy.spatial.transform import Rotation

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.motion import joint_rotations
from kinetree.tasks.numerics.input.synth.people import person

ADULT = yaml.safe_load((files("kinetree.configs") / "people" / "adult.yaml").read_text("utf-8"))
MOTIONS = sorted(ADULT["motions"])


def drawn(seed, motion="walk"):
    return Figure.of(person(ADULT, motion, seed))


def bones(figure):
    child = [j for j, p in enumerate(figure.parents) if p >= 0]
    lengths = np.linalg.norm(figure.rest[child] - figure.rest[figure.parents[child]], axis=1)
    return dict(zip([figure.names[j] for j in child], lengths, strict=True))


@pytest.mark.parametrize(("seed", "motion"), [(seed, motion) for motion in MOTIONS for seed in (0, 11)])
def test_every_frame_of_a_person_is_one_closed_sphere(seed, motion):
    clip = Body.of(drawn(seed, motion), frames=24, fps=12, vertices=6000, seed=seed)
    for t in range(0, 24, 5):
        solid = trimesh.Trimesh(*clip.frame(t), process=False)
        assert solid.is_watertight, t
        assert (solid.euler_number, solid.body_count) == (2, 1), t


@pytest.mark.parametrize("motion", MOTIONS)
def test_poses_at_common_times_are_the_same_at_12_and_60_frames_a_second(motion):
    figure = drawn(4, motion)
    slow, fast = (Body.of(figure, frames=n, fps=fps) for n, fps in ((13, 12), (61, 60)))
    np.testing.assert_allclose(fast.X[::5], slow.X, atol=1e-9 * figure.height)
    np.testing.assert_allclose(fast.G[::5], slow.G, atol=1e-9)
    assert np.abs(fast.X[1] - fast.X[0]).max() < np.abs(slow.X[1] - slow.X[0]).max()


@pytest.mark.parametrize("motion", MOTIONS)
def test_no_joint_jumps_and_accelerations_are_those_of_people(motion):
    """Peaks of angular velocity and acceleration, as a thrower's arm has them, at the ends of keys too."""
    figure, rate = drawn(2, motion), 600.0
    R, _ = joint_rotations(figure, figure.motion(None), np.arange(0.0, 5.5, 1.0 / rate))
    for j, name in enumerate(figure.names):
        turn = (Rotation.from_matrix(R[:-1, j]).inv() * Rotation.from_matrix(R[1:, j])).as_rotvec(degrees=True) * rate
        assert np.linalg.norm(turn, axis=1).max() < 900.0, name
        assert np.linalg.norm(np.diff(turn, axis=0), axis=1).max() * rate < 9000.0, name


def test_a_seed_is_a_person_and_seeds_differ_in_size_and_shares():
    assert drawn(3) == drawn(3)
    people = [drawn(seed) for seed in range(24)]
    heights = np.array([figure.height for figure in people])
    assert heights.max() > 1.3 * heights.min()
    for bone, other, least in (("elbow_l", "knee_l", 0.12), ("head_top", "spine", 0.2)):
        shares = [bones(figure)[bone] / bones(figure)[other] for figure in people]
        assert max(shares) / min(shares) > 1.0 + least
    eared = sum("ear_l" in figure.names for figure in people)
    assert 6 <= eared <= 18


def test_sides_of_a_person_are_unequal_as_those_of_people_are():
    differences = []
    for seed in range(12):
        length = bones(drawn(seed))
        differences += [abs(length[f"{limb}_l"] / length[f"{limb}_r"] - 1.0) for limb in ("elbow", "wrist", "knee", "ankle")]
    assert 0.003 < np.median(differences) < 0.03
    assert max(differences) < 0.08


def test_who_looks_around_turns_the_head_far_to_both_sides():
    for seed in range(4):
        clip = Body.of(drawn(seed, "look"), frames=36, fps=12)
        R = clip.R[:, clip.figure.names.index("head")]
        yaw = np.degrees(np.arctan2(R[:, 1, 0], R[:, 0, 0]))
        assert yaw.max() > 35.0
        assert yaw.min() < -35.0
        assert np.ptp(yaw) > 90.0


def test_another_motion_of_a_seed_leaves_the_body_as_it_is():
    assert drawn(5, "walk").joints == drawn(5, "throw").joints
    assert drawn(5).joints != drawn(6).joints


def test_unknown_motion_is_refused_with_the_nearest():
    with pytest.raises(FigureError, match=r"adult:SEED have no motion 'wlk'; did you mean 'walk'"):
        person(ADULT, "wlk", 0)
