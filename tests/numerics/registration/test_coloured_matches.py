"""A round tube turned about its axis: only its colours show how far."""

import numpy as np
import pytest
from limbs import rotation, tube
from painted import waves
from shipped import FITTING, GRAPH

from kinetree.tasks.numerics.registration.block_system import add_data, add_forms
from kinetree.tasks.numerics.registration.colour_agreement import colour_agreement, suffices
from kinetree.tasks.numerics.registration.colour_term import ColourSettings, Compared, FrameColour
from kinetree.tasks.numerics.registration.coloured_matches import agreeing_colours, coloured_matches, forms_of_matches
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import at_rest, fit, shape
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph

TURN = np.radians(25.0)


@pytest.fixture(scope="module")
def round_body():
    """A round tube."""
    return deformation_graph(*tube(flat=1.0), GRAPH._replace(nodes=80))


def turned(body, colour):
    """The tube turned about its axis, cut into other vertices; `colour` makes its colours from points of the tube at rest."""
    V, F = tube(around=29, along=57, start=0.07, flat=1.0)
    shown = None if colour is None else FrameColour(colour(V), waves(body.V))
    return Target.of(V @ rotation((0, 0, 1), TURN).T, F, body.size, colour=shown)


def sliding(body, target):
    """Mean distance of the fitted vertices to where they belong, away from the ends, share of that of no turn."""
    x = shape(body, fit(body, at_rest(body), target, FITTING).pose)[0]
    middle = np.abs(body.V[:, 2]) < 3.5
    true = body.V @ rotation((0, 0, 1), TURN).T
    return float((np.linalg.norm(x - true, axis=1)[middle]).mean() / np.linalg.norm(body.V - true, axis=1)[middle].mean())


def test_roll_of_a_round_limb_comes_back_by_its_colours(round_body) -> None:
    assert sliding(round_body, turned(round_body, None)) > 0.8
    assert sliding(round_body, turned(round_body, waves)) < 0.3


def test_exposure_changes_little(round_body) -> None:
    assert sliding(round_body, turned(round_body, lambda V: 0.6 * waves(V) + 0.1)) < 0.3


def test_colours_that_do_not_agree_change_no_bit(round_body) -> None:
    noise = np.random.default_rng(0)
    without = fit(round_body, at_rest(round_body), turned(round_body, None), FITTING)
    target = turned(round_body, lambda V: noise.random((len(V), 3)))
    found = fit(round_body, at_rest(round_body), target, FITTING)
    assert np.array_equal(found.pose.rotation, without.pose.rotation)
    assert np.array_equal(found.pose.translation, without.pose.translation)


def test_nearest_in_colour_too_is_nearer_to_the_truth(round_body) -> None:
    target = turned(round_body, waves)
    samples = round_body.sample, target.sample
    x, n = shape(round_body, at_rest(round_body))
    near = target.nearest(x[samples[0]], n[samples[0]])
    colour = Compared(waves(round_body.V), target.colour.frame, 1.0, 0.03)
    found = coloured_matches(round_body, target, samples, x, n, None, colour, 0.01)
    true = (round_body.V @ rotation((0, 0, 1), TURN).T)[samples[0]]
    middle = np.abs(true[:, 2]) < 3.5
    before, after = (np.linalg.norm(target.V[match] - true, axis=1)[middle].mean() for match in (near, found[0]))
    assert after < 0.8 * before


def test_agreement_is_high_where_colours_are_the_body_s_and_nothing_where_there_are_none(round_body) -> None:
    pose = at_rest(round_body)
    V, F = tube(around=29, along=57, start=0.07, flat=1.0)
    own = Target.of(V, F, round_body.size, colour=FrameColour(waves(V), waves(round_body.V)))
    assert colour_agreement(round_body, pose, own) > 0.95
    noise = FrameColour(np.random.default_rng(0).random(V.shape), waves(round_body.V))
    assert colour_agreement(round_body, pose, Target.of(V, F, round_body.size, colour=noise)) < 0.1
    assert colour_agreement(round_body, pose, Target.of(V, F, round_body.size)) == 0.0


def test_most_frames_must_agree() -> None:
    assert suffices(np.array([0.9, 0.0, 0.9]))
    assert not suffices(np.array([0.0, 0.9, 0.0]))
    assert not suffices(np.empty(0))


def test_forms_of_planes_and_points_add_what_planes_and_points_do(round_body) -> None:
    body, pose = round_body, at_rest(round_body)
    rng = np.random.default_rng(0)
    vertex, r = body.sample[:50], rng.normal(size=(50, 3))
    n, plane, near = body.N[vertex], rng.random(50), rng.random(50)
    told = body.V, body.bound, body.weight, body.of_vertex, pose.rotation, body.g, vertex
    shapes = (len(body.node), 6, 6), (len(body.pair), 6, 6), (len(body.node), 6)
    one, other = ([np.zeros(s) for s in shapes] for _ in range(2))
    add_data(*one, *told, r, n, plane, near)
    form = plane[:, None, None] * n[:, :, None] * n[:, None, :] + near[:, None, None] * np.eye(3)
    add_forms(*other, *told, form, np.einsum("rxy,ry->rx", form, r))
    for a, b in zip(one, other, strict=True):
        np.testing.assert_allclose(a, b, atol=1e-12)


def test_plain_skin_holds_nothing(round_body) -> None:
    target = turned(round_body, lambda V: np.full(V.shape, 0.5))
    samples = round_body.sample, target.sample
    pairs = target.sample[np.zeros(len(samples[0]), int)], samples[0][np.zeros(len(samples[1]), int)]
    colour = agreeing_colours(round_body, target, samples, pairs, ColourSettings(agreement=-1e9))
    assert colour is not None
    H = forms_of_matches(target, colour, samples[0], pairs[0], np.ones((len(samples[0]), 3)), np.ones(len(samples[0])))[0]
    assert np.abs(H).max() < 1e-9
