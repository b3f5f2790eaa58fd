"""Laws of random trees: whatever the seed, a figure that can be surfaced, scored and told from its siblings."""

import numpy as np
import pytest
import trimesh

from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.clearance import clearance
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.trees import random_tree


@pytest.mark.parametrize("seed", range(8))
def test_a_random_tree_is_one_closed_sphere_in_every_frame_and_its_limbs_turn(seed):
    clip = Body.of(random_tree(seed), frames=36, vertices=2500, seed=seed)
    truth = clip.truth()
    still = [joint["name"] for joint in truth["joints"] if joint["kind"] == "joint" and not joint["scored"]]
    assert all(name.startswith("trunk") for name in still)
    for t in range(0, 36, 5):
        solid = trimesh.Trimesh(*clip.frame(t), process=False)
        assert solid.is_watertight, t
        assert (solid.euler_number, solid.body_count) == (2, 1), t
    assert clearance(clip.figure, clip.flesh, clip.X).min() > 0.0


def test_a_seed_is_a_tree_and_seeds_differ_in_limbs_and_size():
    assert random_tree(3) == random_tree(3)
    trees = [random_tree(seed) for seed in range(10)]
    assert len({len(tree.joints) for tree in trees}) >= 4
    assert len({sum(name.endswith("end") for name in tree.names) for tree in trees}) >= 3
    heights = [tree.height for tree in trees]
    assert max(heights) > 10.0 * min(heights)


def test_clearance_is_the_gap_between_limbs_and_negative_when_they_overlap():
    joints = [{"name": "a", "position": [0, 0, 10], "radius": 1}]
    for name, parent, place in (("b", "a", [0, 0, 0]), ("c", "b", [5, 0, 0]), ("d", "c", [5, 0, 10])):
        joints.append({"name": name, "parent": parent, "position": place, "radius": 1})
    figure = Figure.of({"name": "fork", "joints": joints})
    leaning, crossing = figure.rest.copy(), figure.rest.copy()
    leaning[[0, 3], 0] = 1.5, 3.8
    crossing[[0, 3], 0] = 2.0, 3.5
    gaps = clearance(figure, Flesh.of(figure), np.stack([leaning, crossing]))
    np.testing.assert_allclose(gaps, [0.3, -0.5], atol=1e-12)
