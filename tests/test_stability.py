"""Laws of shaken alignments: a shake is repeatable, smooth, as large as asked for, and another one in every frame."""

import importlib.util
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from kinetree.schemas.registration.alignment import Alignment

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


def moved(shaken: ModuleType, monkeypatch: pytest.MonkeyPatch, shake: int, frame: int) -> np.ndarray:
    """How far the task moves the vertices of a frame whose alignment is the reference itself."""
    zero = np.zeros(len(V))
    still = Alignment(vertices=V, residual=zero, stretch=zero + 1.0, confidence=zero + 1.0, uncovered=0.0)
    monkeypatch.setattr(shaken, "aligned", lambda *_: still)
    params = shaken.ShakenParams(shake=shake, share=0.01)
    return np.asarray(shaken.alignment(None, SimpleNamespace(vertices=V), None, None, (), params, (frame,)).vertices - V)


def test_a_shake_is_the_same_every_time_and_another_in_every_frame(shaken: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    first, again, *others = (moved(shaken, monkeypatch, *which) for which in ((1, 0), (1, 0), (1, 1), (2, 0)))
    assert np.array_equal(first, again)
    for other in others:
        assert np.linalg.norm(first - other, axis=1).mean() > 0.005


def test_no_shake_leaves_the_alignment_as_it_is(shaken: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    assert not moved(shaken, monkeypatch, 0, 1).any()


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
