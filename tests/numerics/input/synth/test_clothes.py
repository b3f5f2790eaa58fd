"""Laws of loose clothes: around the limbs, closed, behind the body, folded, and no part of the truth."""

from importlib.resources import files

import numpy as np
import pytest
import trimesh
import yaml

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.clothes import outfit
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.implicit import values
from kinetree.tasks.numerics.input.synth.people import person

ADULT = yaml.safe_load((files("kinetree.configs") / "people" / "adult.yaml").read_text("utf-8"))
LEG = {
    "name": "leg",
    "joints": [
        {"name": "hip", "position": [0, 0, 0], "radius": 20},
        {"name": "knee", "parent": "hip", "position": [0, 0, -200], "radius": 20},
        {"name": "foot", "parent": "knee", "position": [0, 0, -400], "radius": 20},
    ],
    "motions": {"kick": {"hip": [{"axis": [1, 0, 0], "amplitude": 60, "frequency": 1.0}]}},
}
TROUSERS = {"name": "leg", "from": ["hip"], "to": ["knee"], "span": [0.1, 0.9], "radii": [30, 40], "folds": 4}


def leg(**garment):
    return Figure.of({**LEG, "clothes": [{**TROUSERS, **garment}]})


def wearing(seed, motion="walk", **settings):
    return Body.of(Figure.of(person(ADULT, motion, seed, clothed=True)), seed=seed, **settings)


@pytest.mark.parametrize(("seed", "motion"), [(1, "run"), (3, "squat"), (6, "greet")])
def test_every_frame_of_a_clothed_person_is_one_closed_surface(seed, motion):
    clip = wearing(seed, motion, frames=12, fps=12, vertices=3000)
    for t in (0, 4, 9):
        solid = trimesh.Trimesh(*clip.frame(t), process=False)
        assert solid.is_watertight, t
        assert solid.body_count == 1, t
        assert abs(len(solid.vertices) / 3000 - 1.0) < 0.1, t


def test_a_garment_without_folds_or_lag_is_a_tube_with_flat_ends():
    clip = Body.of(leg(folds=1, depth=0.0, lag=0.0), frames=1)
    # knots of the radius: 30 at a tenth of the way, 40 at nine tenths
    on = np.array([[0, 30.0, -20], [0, 35.0, -100], [0, -40.0, -180], [0, 30.0, -180], [5.0, 25.0, -20]])
    rotated = on @ clip.G[0, 0].T
    field = values(clip._cones(0), rotated)[0]
    np.testing.assert_allclose(field, 0.0, atol=0.1)


def test_folds_make_the_hem_wavy_and_leave_the_waist_round():
    clip = Body.of(leg(depth=0.1, lag=0.0), frames=1)
    turn = np.linspace(0.0, 2.0 * np.pi, 200)

    def spread(z):
        ring = np.stack([40.0 * np.sin(turn), 40.0 * np.cos(turn), np.full(200, z)], axis=1) @ clip.G[0, 0].T
        return np.ptp(values(clip._cones(0), ring)[0])

    assert spread(-175.0) > 4.0
    assert spread(-25.0) < 0.2 * spread(-175.0)


def test_clothes_come_after_the_body_and_slide_over_the_skin():
    late, prompt = (Body.of(leg(lag=lag, depth=0.0), frames=13, fps=12) for lag in (0.1, 0.0))
    np.testing.assert_array_equal(late.X, prompt.X)
    hem = [clip.worn.A[:, 0] + clip.worn.D[:, 0] for clip in (late, prompt)]
    speed = np.gradient(hem[1], axis=0)
    behind = np.einsum("ti,ti->t", hem[0] - hem[1], speed)
    fast = np.linalg.norm(speed, axis=1) > 0.5 * np.linalg.norm(speed, axis=1).max()
    assert (behind[1:-1][fast[1:-1]] < 0.0).all()
    assert np.linalg.norm(hem[0] - hem[1], axis=1).max() < 0.5 * 40.0 + 1e-9


def test_clothes_change_neither_joints_nor_true_parts():
    bare, worn = (Figure.of(person(ADULT, "walk", 3, clothed=c)) for c in (False, True))
    one, two = (Body.of(f, frames=4, vertices=1500) for f in (bare, worn))
    assert one.truth() == two.truth()
    V, _ = two.frame(2)
    np.testing.assert_array_equal(one.parts(2, V), two.parts(2, V))
    assert np.abs(values(one._cones(2), V)[0]).max() > 0.01 * bare.height


def test_clothes_are_the_same_at_any_frame_rate():
    slow, fast = (wearing(3, "dance", frames=n, fps=fps) for n, fps in ((5, 12), (21, 60)))
    for a, b in zip(slow.worn, fast.worn, strict=True):
        np.testing.assert_allclose(b[::5], a, atol=1e-6)


def test_some_people_wear_skirts_and_some_trousers():
    worn = [{garment["name"] for garment in outfit(ADULT["joints"], seed)} for seed in range(8)]
    assert 1 <= sum("skirt" in names for names in worn) <= 7
    assert all(("skirt" in names) != ("thigh_l" in names) for names in worn)


@pytest.mark.parametrize(
    ("garment", "words"),
    [
        ({"to": ["kne"]}, "to 'kne' is no joint; did you mean 'knee'?"),
        ({"to": ["hip"]}, "expected one or as many, and others"),
        ({"span": [0.9, 0.1]}, "expected two increasing shares"),
        ({"radii": 3}, "radii is 3, expected a list"),
        ({"radii": [-1, 2]}, "radii is -1, expected more than 0"),
        ({"depth": 1}, "depth is 1, expected more than"),
        ({"colour": "red"}, "unknown key 'colour'"),
    ],
)
def test_a_garment_that_cannot_be_is_refused_by_name(garment, words):
    with pytest.raises(FigureError) as refusal:
        leg(**garment)
    assert words in str(refusal.value)
    assert "garment 'leg'" in str(refusal.value)


def test_clothes_over_one_skinned_mesh_are_refused():
    with pytest.raises(FigureError, match="fixed connectivity can have no clothes"):
        Body.of(leg(), connectivity="fixed")
