"""Laws of contacts: the limb's end reaches its target, and what cannot be reached is refused."""

import numpy as np
import pytest

from kinetree.errors import FigureError
from kinetree.tasks.numerics.input.synth.contacts import Contact, bending_chain, merging, touching
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import values
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics, joint_rotations


def gripper(reach=3.0):
    """A post with a block on top, and an arm of two bones that hangs on the post's foot."""
    joints = [
        {"name": "foot", "position": [0, 0, 0], "radius": 0.6},
        {"name": "middle", "parent": "foot", "position": [0, 0, 2], "radius": 0.6},
        {"name": "top", "parent": "middle", "position": [0, 0, 5], "radii": [0.6, 0.6, 1.0]},
        {"name": "shoulder", "parent": "foot", "position": [2, 0, 0], "radius": 0.4},
        {"name": "elbow", "parent": "shoulder", "position": [2 + reach, 0, 1], "radius": 0.4},
        {"name": "hand", "parent": "elbow", "position": [2.2 + reach, 0, 1 + reach], "radius": 0.4},
        {"name": "tail", "parent": "foot", "position": [-2, 0, 0], "radius": 0.4},
        {"name": "tail_end", "parent": "tail", "position": [-4, 0, 0], "radius": 0.4},
    ]
    sway = {"middle": [{"axis": [0, 1, 0], "amplitude": 8}], "elbow": [{"axis": [0, 1, 0], "amplitude": 10}]}
    return Figure.of({"name": "gripper", "joints": joints, "motions": {"sway": sway}})


def bent(figure, row, frames=20):
    R, shift = joint_rotations(figure, figure.motion(None), np.arange(frames) / 20.0)
    flesh = Flesh.of(figure)
    R = touching(figure, flesh, Contact.of(figure, row, frames), R, shift)
    return flesh, *forward_kinematics(figure.rest, figure.parents, R, shift)


def test_the_limbs_end_overlaps_the_rest_of_the_body_in_the_contact_and_only_there():
    figure = gripper()
    flesh, X, G = bent(figure, {"limb": "hand", "target": "top", "begin": 8, "end": 12, "ramp": 3})
    arm = np.isin(flesh.parent, [figure.names.index(n) for n in ("shoulder", "elbow")])
    hand = figure.names.index("hand")
    others = np.array([values(flesh.at(x, g, arm), x[[hand]])[0][0] for x, g in zip(X, G, strict=True)])
    assert np.flatnonzero(others < 0.4).tolist() == [8, 9, 10, 11, 12]
    assert others[8:13].min() > 0.0


def test_a_direction_says_on_which_side_the_target_is_touched():
    figure = gripper()
    for side in ([0.0, 1.0, 0.0], [0.0, -1.0, 0.0]):
        row = {"limb": "hand", "target": "top", "begin": 8, "end": 12, "direction": side}
        _, X, G = bent(figure, row)
        offset = X[10, figure.names.index("hand")] - X[10, figure.names.index("top")]
        local = G[10, figure.names.index("middle")].T @ offset
        np.testing.assert_allclose(local / np.linalg.norm(local), side, atol=0.02)


def test_the_weight_of_a_contact_is_one_in_it_and_falls_at_once_beside_it():
    contact = Contact(2, 0, 4, 6, 2, None)
    weight = contact.weights(12)
    assert (weight[4:7] == 1.0).all()
    assert weight[[3, 7]].max() < 0.5
    assert weight[[0, 1, 9, 10, 11]].tolist() == [0.0] * 5


def test_a_limb_bends_from_its_end_to_the_trunk():
    figure = gripper()
    names = figure.names
    assert [names[j] for j in bending_chain(figure, names.index("hand"))] == ["elbow", "shoulder"]
    assert bending_chain(figure, names.index("shoulder")) == []


@pytest.mark.parametrize(
    ("row", "words"),
    [
        ({"limb": "hnad"}, "did you mean 'hand'"),
        ({"target": "tip"}, "has no joint 'tip'"),
        ({"begin": 9, "end": 3}, "0 ≤ begin ≤ end < 20"),
        ({"end": 20}, "0 ≤ begin ≤ end < 20"),
        ({"begin": 1.5}, "whole numbers"),
        ({"limb": "shoulder"}, "has no joint to bend"),
        ({"target": "elbow"}, "is part of the limb that shall touch it"),
        ({"direction": [0, 0, 0]}, "not all zero"),
        ({"direction": "up"}, "expected three numbers"),
        ({"begins": 3}, "unknown key 'begins'; did you mean 'begin'"),
    ],
)
def test_a_contact_that_cannot_be_is_refused_in_words(row, words):
    with pytest.raises(FigureError) as refusal:
        Contact.of(gripper(), {"limb": "hand", "target": "top", "begin": 3, "end": 5, **row}, 20)
    assert words in str(refusal.value)


def test_a_contact_without_its_target_is_refused_in_words():
    with pytest.raises(FigureError, match="target is missing"):
        Contact.of(gripper(), {"limb": "hand", "begin": 3, "end": 5}, 20)


def test_a_limb_that_is_too_short_is_refused_with_the_length_it_lacks():
    with pytest.raises(FigureError, match=r"turning elbow, shoulder leaves the limb [\d.]+ unknown short of it"):
        bent(gripper(reach=0.8), {"limb": "hand", "target": "top", "begin": 8, "end": 12})


def test_touching_skins_blend_where_the_limbs_end_meets_the_body_and_nowhere_else():
    figure = gripper()
    flesh, X, G = bent(figure, {"limb": "hand", "target": "top", "begin": 8, "end": 12, "ramp": 3})
    contact = Contact(figure.names.index("hand"), figure.names.index("top"), 8, 12, 3, None)
    cones = flesh.at(X[10], G[10])
    P = X[10].mean(axis=0) + np.random.default_rng(0).uniform(-6.0, 6.0, (20000, 3))
    apart, together = values(cones, P)[0], values(merging(figure, flesh, contact, cones), P)[0]
    changed = together < apart - 1e-9
    assert (together <= apart + 1e-9).all()
    near_skin = changed & (np.abs(apart) < 0.2)
    assert near_skin.any()
    assert np.linalg.norm(P[near_skin] - X[10, contact.limb], axis=1).max() < 4.0 * 0.4
