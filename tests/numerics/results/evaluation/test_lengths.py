"""Bones of known lengths."""

import numpy as np
import pytest

from kinetree.tasks.numerics.results.evaluation.lengths import length_variation


def test_rigid_bone_varies_by_nothing_however_it_moves():
    t = np.linspace(0, 3, 20)
    tip = np.stack([np.cos(t), np.sin(t), np.zeros(20)], axis=1)
    X = np.stack([np.zeros((20, 3)), tip], axis=1) + np.random.default_rng(0).normal(size=(20, 1, 3))
    assert length_variation(X, (-1, 0)) == pytest.approx([0.0], abs=1e-12)


def test_bone_of_lengths_one_and_three_varies_by_half_its_mean():
    X = np.zeros((2, 2, 3))
    X[:, 1, 0] = [1, 3]
    assert length_variation(X, (-1, 0)) == pytest.approx([0.5])
    assert length_variation(10 * X, (-1, 0)) == pytest.approx([0.5])


def test_bone_without_length_and_body_without_bones_vary_by_nothing():
    assert length_variation(np.zeros((3, 2, 3)), (-1, 0)).tolist() == [0.0]
    assert length_variation(np.zeros((3, 1, 3)), (-1,)).tolist() == []
