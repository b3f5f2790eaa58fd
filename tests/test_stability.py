"""Laws of shaken alignments: a shake is repeatable, smooth, as large as asked for, and another one in every frame.

And what is said of several of them.
"""

import importlib.util
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace

import numpy as np
import pytest

from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.evaluation import JointScore, Summary

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


@pytest.fixture(scope="module")
def stability() -> Iterator[ModuleType]:
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(str(FOLDER))
        yield importlib.import_module("stability")


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


def test_joints_of_a_shake_are_counted_and_those_lost_are_named(stability: ModuleType) -> None:
    joints = (JointScore(name="knee", scored=True, found="a"), JointScore(name="toe", scored=True), JointScore(name="jaw"))
    summary = Summary(scored=2, found=1, spurious=3, percent=1.5)
    assert stability.Shaken.of(SimpleNamespace(joints=joints, summary=summary)) == (1, 2, 1.5, 3, ("toe",))
    nothing = stability.Shaken.of(SimpleNamespace(joints=joints[1:], summary=Summary(scored=1)))
    assert (nothing.matched, math.isnan(nothing.percent)) == (0, True)


def test_a_sequence_without_truth_is_refused_in_words(stability: ModuleType) -> None:
    with pytest.raises(SystemExit, match="no truth is known of it"):
        stability.Shaken.of(SimpleNamespace(joints=(), summary=None))


def test_the_table_has_every_shake_the_deviation_of_a_sample_and_how_often_joints_are_lost(stability: ModuleType) -> None:
    plain = stability.Shaken(3, 4, 1.0, 0, ("neck",))
    shaken = [
        stability.Shaken(2, 4, 1.0, 0, ("toe", "knee")),
        stability.Shaken(4, 4, 2.0, 0, ()),
        plain._replace(lost=("toe",)),
    ]
    first, *rows, mean, lost = stability.lines("wolf", [plain, *shaken])
    assert " ".join(first.split()) == "wolf as it is 3 of 4 1.00 % 0"
    assert [row.split()[1] for row in rows] == ["1", "2", "3"]
    assert mean.split(maxsplit=2)[2] == "3.00 ± 1.00 of 4, 1.33 ± 0.58 %, spurious 0.00 ± 0.00"
    assert lost.split(maxsplit=2)[2] == "toe 2 of 3, knee 1 of 3"


def test_of_one_shake_the_deviation_is_not_known(stability: ModuleType) -> None:
    plain = stability.Shaken(3, 4, 1.0, 0, ())
    assert "3.00 ± nan of 4" in list(stability.lines("wolf", [plain, plain]))[2]
    assert len(list(stability.lines("wolf", [plain]))) == 1
