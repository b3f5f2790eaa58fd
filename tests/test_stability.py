"""Laws of shaken alignments: a shake is repeatable, smooth, as large as asked for, and another one in every frame."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

FOLDER = Path(__file__).resolve().parent.parent / "benchmarks"
V = np.stack(np.meshgrid(*(np.linspace(0.0, 1.0, 9),) * 3), axis=-1).reshape(-1, 3)


@pytest.fixture(scope="module")
def shaken() -> ModuleType:
    spec = importlib.util.spec_from_file_location("shaken_alignment", FOLDER / "shaken_alignment.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def test_a_shake_is_the_same_every_time_and_another_in_every_frame(shaken: ModuleType) -> None:
    first, again, other = (shaken.waves(V, np.random.default_rng((1, frame)), 0.01) for frame in (0, 0, 1))
    assert np.array_equal(first, again)
    assert np.linalg.norm(first - other, axis=1).mean() > 0.005


def test_a_shake_is_as_large_as_asked_for(shaken: ModuleType) -> None:
    every = np.stack([shaken.waves(V, np.random.default_rng(k), 0.01) for k in range(200)])
    assert np.sqrt((every**2).mean()) == pytest.approx(0.01, rel=0.1)


def test_a_shake_scales_with_the_body(shaken: ModuleType) -> None:
    small, large = (shaken.waves(s * V, np.random.default_rng(3), 0.01) for s in (1.0, 1000.0))
    np.testing.assert_allclose(large, 1000.0 * small, rtol=1e-9)


def test_a_shake_is_smooth(shaken: ModuleType) -> None:
    here, beside = V, V + [0.01, 0.0, 0.0]
    moved = [np.stack([shaken.waves(x, np.random.default_rng(k), 0.01) for k in range(50)]) for x in (here, beside)]
    assert np.abs(moved[1] - moved[0]).max() < 0.5 * np.abs(moved[0]).max()
