"""Laws of soft flesh: it stays behind what accelerates, swells where a joint bends, and leaves the skeleton alone."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import values
from kinetree.tasks.numerics.input.synth.softness import STEP, Softness, softened

ARM = {
    "name": "arm",
    "joints": [
        {"name": "shoulder", "position": [0, 0, 0], "radius": 30},
        {"name": "elbow", "parent": "shoulder", "position": [0, 0, 300], "radius": 30},
        {"name": "hand", "parent": "elbow", "position": [0, 0, 600], "radius": 20},
    ],
    "motions": {"bend": {"elbow": [{"axis": [1, 0, 0], "amplitude": 45, "frequency": 1.5}]}},
}


def arm(**softness):
    return Figure.of({**ARM, "softness": softness})


def test_flesh_of_a_limb_that_swings_answers_as_a_spring_does():
    """X = A sin ωt along x: a = −ω²x, so that the flesh is (ω / ω₀)² x ahead of where it would be, opposite to a."""
    figure, omega, amplitude = arm(frequency=50.0, most=0.4), 2.0 * np.pi, 3.0
    flesh, t = Flesh.of(figure), np.linspace(0.0, 1.0, 9)

    def at(s):
        return figure.rest + amplitude * np.sin(omega * s)[:, None, None] * np.array([1.0, 0.0, 0.0])

    sag = figure.softness.sag((flesh.parent, flesh.child), flesh.table.mean(axis=1), at(t - STEP), at(t), at(t + STEP))
    expected = amplitude * np.sin(omega * t) / 50.0**2
    np.testing.assert_allclose(sag[:, 0, 0], expected, atol=2e-6)
    np.testing.assert_allclose(sag[:, :, 1:], 0.0, atol=1e-12)


def test_flesh_never_goes_farther_than_its_share_of_the_radius_and_not_along_the_limb():
    figure = arm(frequency=0.6, most=0.2)
    flesh = Flesh.of(figure)
    shaken = np.random.default_rng(0).normal(size=(3, 20, 3, 3)) * 5.0 + figure.rest
    sag = figure.softness.sag((flesh.parent, flesh.child), flesh.table.mean(axis=1), *shaken)
    most = 0.2 * flesh.table.mean(axis=1)
    assert (np.linalg.norm(sag, axis=2) < most).all()
    assert np.linalg.norm(sag, axis=2).max() > 0.9 * most.min()
    D = shaken[1][:, flesh.child] - shaken[1][:, flesh.parent]
    np.testing.assert_allclose(np.einsum("tbi,tbi->tb", sag, D), 0.0, atol=1e-9)


def test_surface_in_the_middle_of_a_limb_goes_with_its_flesh_and_swells():
    figure = arm(bulge=0.1)
    flesh = Flesh.of(figure)
    cones = flesh.at(figure.rest, np.tile(np.eye(3), (3, 1, 1)))
    moved = softened(cones, np.array([[4.0, 0, 0], [0, 0, 0]]), np.array([0.1, 0.0]))
    on = np.array([[30.0 * 1.1 + 4.0, 0, 150], [4.0 - 30.0 * 1.1, 0, 150], [25.0, 0, 450]])
    np.testing.assert_allclose(values(moved, on)[0], 0.0, atol=1e-9)
    assert np.abs(values(cones, on[:2])[0]).min() > 0.9


def test_a_limb_swells_as_the_joint_beyond_it_bends():
    clip = Body.of(arm(bulge=0.1), frames=13, fps=12)
    swelling = clip.figure.softness.swelling((clip.flesh.parent, clip.flesh.child), clip.R)
    angle = np.arccos(np.clip(0.5 * (np.trace(clip.R[:, 1], axis1=1, axis2=2) - 1.0), -1, 1))
    np.testing.assert_allclose(swelling[:, 0], 0.1 * (1.0 - np.cos(angle)), atol=1e-12)
    np.testing.assert_array_equal(swelling[:, 1], 0.0)


def test_soft_flesh_moves_the_surface_and_no_joint():
    rigid, soft = (Body.of(figure, frames=6, vertices=800) for figure in (Figure.of(ARM), arm(bulge=0.1)))
    np.testing.assert_array_equal(rigid.X, soft.X)
    assert rigid.truth() == soft.truth()
    V, F = soft.frame(3)
    assert trimesh.Trimesh(V, F, process=False).is_watertight
    assert np.abs(values(rigid._limbs(3), V)[0] - values(soft._limbs(3), V)[0]).max() > 0.5


def test_a_skinned_mesh_follows_the_soft_surface():
    clip = Body.of(arm(bulge=0.1), frames=4, vertices=800, connectivity="fixed")
    for t in range(4):
        assert np.abs(values(clip._limbs(t), clip.frame(t)[0])[0]).max() < 0.5


def test_flesh_is_the_same_at_any_frame_rate():
    slow, fast = (Body.of(arm(), frames=n, fps=fps) for n, fps in ((7, 12), (31, 60)))
    np.testing.assert_allclose(fast.sag[::5], slow.sag, atol=1e-9)


@pytest.mark.parametrize(
    ("softness", "words"),
    [
        ({"frequency": 0}, "frequency is 0, expected more than 0.5"),
        ({"bulge": 2}, "bulge is 2, expected more than"),
        ({"speed": 1}, "unknown key 'speed'"),
    ],
)
def test_softness_that_cannot_be_is_refused(softness, words):
    with pytest.raises(FigureError) as refusal:
        arm(**softness)
    assert words in str(refusal.value)


def test_softness_is_a_value():
    assert Softness.of("arm", {}) == Softness(6.0, 0.2, 0.0, 0.8)
