"""Laws of figures written as data: order, defaults, and refusals that name the joint and the nearest known word."""

import copy

import pytest

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.figures import Figure

HINGE = {
    "name": "hinge",
    "unit": "m",
    "joints": [
        {"name": "root", "position": [0, 0, 0], "radius": 1},
        {"name": "knee", "parent": "root", "position": [0, 0, 5], "radius": 0.5},
        {"name": "toe", "parent": "knee", "position": [0, 0, 9], "radii": [0.5, 0.6, 0.2]},
    ],
    "motions": {"nod": {"knee": [{"axis": [2, 0, 0], "amplitude": 20}]}},
}


def altered(path, value):
    figure = copy.deepcopy(HINGE)
    *way, last = path
    at = figure
    for step in way:
        at = at[step]
    at[last] = value
    return figure


def test_parents_stand_before_children_whatever_the_order_written():
    turned = {**HINGE, "joints": HINGE["joints"][::-1]}
    assert Figure.of(turned).names == ["root", "knee", "toe"]
    assert Figure.of(turned).parents.tolist() == [-1, 0, 1]


def test_a_limb_without_a_profile_runs_from_its_parents_radius_to_its_own():
    assert Figure.of(HINGE).joints[1].radii == (1.0, 0.5)


def test_height_is_the_largest_extent_of_the_balls_at_rest():
    assert Figure.of(HINGE).height == pytest.approx(9.0 + 1.0 + 0.2)


def test_axes_become_unit_vectors():
    assert Figure.of(HINGE).motion("nod")["knee"][0].axis == (1.0, 0.0, 0.0)


@pytest.mark.parametrize(
    ("path", "value", "words"),
    [
        (("joints", 2, "parent"), "kne", "joint 'toe': parent 'kne' is no joint; did you mean 'knee'?"),
        (("joints", 0, "parent"), "toe", "0 joints have no parent"),
        (("joints", 1, "parent"), None, "2 joints have no parent (root, knee)"),
        (("joints", 1, "parent"), "toe", "hang on each other in a circle"),
        (("joints", 1, "name"), "root", "joint name 'root' is given twice"),
        (("joints", 1, "radius"), -2, "radius is -2, expected more than 0"),
        (("joints", 1, "radius"), "thick", "radius is 'thick', expected a finite number"),
        (("joints", 1, "radius"), float("nan"), "expected a finite number"),
        (("joints", 1, "position"), [0, 0, 0], "it lies at its parent 'root'"),
        (("joints", 1, "position"), [0, 1], "position is [0, 1], expected three numbers"),
        (("joints", 1, "flesh"), [0, 0, -5], "its flesh lies where that of its parent 'root' does"),
        (("joints", 1, "flesh"), 5, "flesh is 5, expected three numbers"),
        (("joints", 1, "radious"), 3, "unknown key 'radious'; did you mean 'radius'?"),
        (("joints", 2, "radii"), [1], "expected at least two"),
        (("joints", 1, "flatten"), 0.5, "flatten needs a side across the limb"),
        (("joints", 1, "flatten"), 1.5, "expected more than 0 and at most 1"),
        (("joints",), "none", "expected a list of at least two joints"),
        (("motions", "nod", "elbow"), [], "'elbow' is no joint"),
        (("motions", "nod", "knee"), "fast", "expected a list of curves"),
        (("motions", "nod", "knee", 0, "axis"), [0, 0, 0], "expected a direction"),
        (("motions", "nod", "knee", 0, "distance"), 4, "exactly one of amplitude, distance and keys"),
        (("motions", "nod", "knee"), [{"axis": [1, 0, 0], "distance": 1}], "only the root may slide"),
        (("motions", "nod", "knee"), [{"axis": [1, 0, 0], "keys": [[0, 1], [0, 2]]}], "increasing seconds"),
        (
            ("motions", "nod", "knee"),
            [{"axis": [1, 0, 0], "keys": [[0, 1], [2, 2]], "period": 2}],
            "period is 2, expected keys that span less than it",
        ),
        (("motions", "nod", "knee", 0, "period"), 2, "period is 2, expected keys that span less than it"),
        (("motions", "nod", "knee"), [{"axis": [1, 0, 0], "keys": [3, 4]}], "a list of pairs"),
        (("motions", "nod", "knee"), [{"axis": [1, 0, 0]}], "exactly one of amplitude, distance and keys"),
        (("fps",), 0, "fps is 0, expected more than 0"),
        (("speed",), 1, "unknown key 'speed'"),
    ],
)
def test_a_figure_that_cannot_be_is_refused_in_words(path, value, words):
    with pytest.raises(FigureError) as refusal:
        Figure.of(altered(path, value))
    assert words in str(refusal.value)
    assert "hinge" in str(refusal.value)


def test_a_figure_without_motions_stands_still():
    still = {key: value for key, value in HINGE.items() if key != "motions"}
    assert dict(Figure.of(still).motion(None)) == {}
