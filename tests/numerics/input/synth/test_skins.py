"""Laws of the fixed connectivity: the same faces, on the surface that is sampled anew, moved rigidly where rigid."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.implicit import values
from kinetree.tasks.numerics.input.synth.skins import Skin

KNEE = {
    "name": "knee",
    "joints": [
        {"name": "hip", "position": [0, 0, 0], "radius": 1},
        {"name": "knee", "parent": "hip", "position": [0, 0, -5], "radius": 0.9},
        {"name": "foot", "parent": "knee", "position": [0, 0, -10], "radius": 0.7},
    ],
    "motions": {"bend": {"knee": [{"axis": [1, 0, 0], "amplitude": 40, "offset": 40, "phase": -0.25}]}},
}


def knee(**settings):
    return Body.of(Figure.of(KNEE), frames=11, fps=10, vertices=1500, **settings)


def test_every_frame_has_the_same_faces():
    clip = knee(connectivity="fixed")
    first = clip.frame(0)[1]
    for t in range(1, 11):
        np.testing.assert_array_equal(clip.frame(t)[1], first)


def test_vertices_lie_on_the_surface_that_is_sampled_anew_in_the_frame():
    fixed, new = knee(connectivity="fixed"), knee()
    for t in range(11):
        V, _ = fixed.frame(t)
        W, _ = new.frame(t)
        cones = fixed.flesh.at(fixed.X[t], fixed.G[t])
        off_fixed, off_new = (np.abs(values(cones, P)[0]).max() for P in (V, W))
        assert off_fixed < 0.002 * fixed.figure.height
        assert off_new < 0.01 * fixed.figure.height


def test_weights_are_a_partition_of_unity_that_is_whole_away_from_the_joint():
    clip = knee(connectivity="fixed")
    W = clip.weights()
    np.testing.assert_allclose(W.sum(axis=1), 1.0)
    assert W.min() >= 0.0
    z = clip.skin.V[:, 2]
    np.testing.assert_array_equal(W[z > -3.0, 0], 1.0)
    np.testing.assert_array_equal(W[z < -7.0, 1], 1.0)
    at_joint = np.abs(z + 5.0) < 0.05
    assert W[at_joint, 0] == pytest.approx(0.5, abs=0.1)


def test_away_from_the_joint_vertices_move_as_the_bone_does():
    clip = knee(connectivity="fixed")
    bend = Rotation.from_rotvec([np.radians(80.0), 0, 0]).as_matrix()
    V, _ = clip.frame(5)
    pivot = np.array([0.0, 0.0, -5.0])
    shin = clip.skin.V[:, 2] < -7.0
    np.testing.assert_allclose(V[shin], (pivot + (clip.skin.V - pivot) @ bend.T)[shin], atol=0.03)


def test_noise_leaves_the_fixed_faces_alone():
    noisy, clean = knee(connectivity="fixed", noise=0.002), knee(connectivity="fixed")
    np.testing.assert_array_equal(noisy.frame(4)[1], clean.frame(4)[1])
    assert not np.array_equal(noisy.frame(4)[0], clean.frame(4)[0])


def test_weights_of_every_vertex_sum_to_one_and_none_is_negative():
    skin = knee().skin
    assert isinstance(skin, Skin)
    assert skin.weights.min() >= 0
    assert skin.weights.sum(axis=1) == pytest.approx(np.ones(len(skin.V)))
