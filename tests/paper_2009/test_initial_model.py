"""Contract of initial_model: a tree of nodes that carry the whole surface."""

import numpy as np
from volumetric import volumetric


def test_parents_come_first_and_weights_sum_to_one() -> None:
    for model in volumetric().initial_model.values():
        assert model.parents[0] == -1
        assert (model.parents[1:] < np.arange(1, len(model.parents))).all()
        assert np.allclose(model.weight.sum(axis=1), 1.0)
        assert (model.label == model.bound[:, 0]).mean() > 0.9


def test_every_leaf_is_a_limb_that_was_followed() -> None:
    for model in volumetric(letter=True).initial_model.values():
        assert sorted(model.track.tolist()) == [0, 1, 2]
