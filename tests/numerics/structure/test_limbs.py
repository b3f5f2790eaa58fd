"""Laws of the limbs of a tree."""

import numpy as np
from walkers import walker

from kinetree.tasks.numerics.structure.limbs import limbs, ways


def test_a_person_has_five_limbs_whatever_hangs_on_their_ends():
    body = walker("human")
    tips = {body.names[limb.joints[0]] for limb in limbs(body.motion.rest, body.motion.parents)}
    assert tips == {"toe_l", "toe_r", "hand_l", "hand_r", "head_top"}


def test_limbs_do_not_depend_on_the_root():
    body = walker("human")
    rest, parents = body.motion.rest, body.motion.parents.copy()
    j, above = body.names.index("knee_l"), -1
    while j >= 0:  # hang the tree on a knee
        parents[j], above, j = above, j, parents[j]
    assert {limb.joints for limb in limbs(rest, parents)} == {limb.joints for limb in limbs(rest, body.motion.parents)}


def test_a_chain_has_no_limbs():
    assert limbs(np.arange(5.0)[:, None] * [1, 0, 0], np.arange(5) - 1) == []


def test_a_way_is_the_sum_of_the_bones_along_it():
    rest = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 0, 4.0]])
    np.testing.assert_allclose(ways(rest, np.array([-1, 0, 1, 0]), 2), [3, 2, 0, 7])
