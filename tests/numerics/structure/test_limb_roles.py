"""Laws of giving limbs their roles."""

import pytest
from walkers import beast, moved, walker

from kinetree.tasks.numerics.structure.limb_roles import AnatomySettings, best_roles, horn_pairs
from kinetree.tasks.numerics.structure.limbs import limbs


@pytest.mark.parametrize("name", ["human", "quadruped"])
def test_the_order_of_limbs_does_not_matter(name):
    body = walker(name).motion
    found = limbs(body.rest, body.parents)
    here = best_roles(body, found, AnatomySettings())
    there = best_roles(body, found[::-1], AnatomySettings())
    assert here.topology == there.topology == name
    assert here.penalty == pytest.approx(there.penalty)
    assert {frozenset(here.legs), frozenset(here.arms)} == {frozenset(there.legs), frozenset(there.arms)}


def test_no_roles_fit_where_the_limit_is_zero():
    body = walker("human").motion
    assert best_roles(body, limbs(body.rest, body.parents), AnatomySettings(limit=0.0)) is None


def test_horns_are_pairs_and_a_body_without_them_has_none():
    horned, bare = moved(beast("horns"), "walk", 0), walker("quadruped")
    tips = [
        {horned.names[limb.joints[0]] for limb in pair}
        for pair in horn_pairs(horned.motion, limbs(horned.motion.rest, horned.motion.parents), AnatomySettings())
    ]
    assert len(tips) == 1
    assert all(len(pair) == 2 for pair in tips)
    assert horn_pairs(bare.motion, limbs(bare.motion.rest, bare.motion.parents), AnatomySettings()) == []
