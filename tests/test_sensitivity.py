"""The benchmark that halves and doubles every setting: what it finds, what it changes, and what it does not compute again."""

import importlib.util
import math
import sys
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from kinetree.pipeline.planning import freshness
from kinetree.pipeline.running import execute
from kinetree.tasks.numerics.registration.deformation import FitSettings
from kinetree.tasks.numerics.structure import rotation_centres
from kinetree.tasks.numerics.structure.part_tree import PartTreeSettings
from kinetree.tasks.numerics.topology.extrema import ExtremaSettings

REQUIRED = (10, *[(0.1, 0.01)] * 4, 30)
"""Values of the fields of FitSettings that have no default."""
PATH = Path(__file__).resolve().parent.parent / "benchmarks" / "sensitivity.py"


@pytest.fixture(scope="module")
def bench() -> ModuleType:
    spec = importlib.util.spec_from_file_location("sensitivity_benchmark", PATH)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


def named(bench: ModuleType, name: str) -> Any:
    return {setting.name: setting for setting in bench.settings()}[name]


def test_settings_are_found_with_their_defaults_and_meanings(bench: ModuleType) -> None:
    field = named(bench, "structure/part_tree.PartTreeSettings.noise")
    assert (field.default, field.shelf) == (0.001, "structure")
    assert field.meaning == "Drift that is none, share of the root of the area"
    assert named(bench, "registration/deformation.FitSettings.searches").default == 3
    assert named(bench, "structure/centre_lines.CentreLinesSettings.slender").default == (1.3, 1.7)
    assert not any(setting.field == "fit" for setting in bench.settings()), "a settings value within another is no number"


def test_half_and_double_respect_kind_and_range(bench: ModuleType) -> None:
    def scaled(default: Any, factor: float, meaning: str = "") -> Any:
        return bench.scaled(bench.Setting("field", "m", "C", "f", default, meaning), factor)

    assert (scaled(3, 0.5), scaled(3, 2.0), scaled(0.2, 0.5), scaled((0.2, 4), 2.0)) == (2, 6, 0.1, (0.4, 8))
    assert scaled(1, 0.5) == "1 has no other value at ×0.5"
    assert scaled(0.0, 2.0) == "0.0 has no other value at ×2"
    assert scaled(-1, 2.0) == "-1 has no other value at ×2"
    assert scaled(math.inf, 0.5) == "inf has no other value at ×0.5"
    assert scaled(0.7, 2.0, "Share of a surface") == "1.4 is no share"
    assert scaled(0.7, 2.0, "Radians") == 1.4
    assert not any(bench.is_numeric(value) for value in (True, (), "1", (True,), ((1, 2),)))


def test_default_is_changed_counted_and_put_back(bench: ModuleType) -> None:
    with bench.varied(named(bench, "structure/part_tree.PartTreeSettings.noise"), 0.5) as uses:
        assert PartTreeSettings() == (0.5, *PartTreeSettings(0.0)[1:])
        assert uses() == 1, "the default was asked for once, the other time a value was given"
        assert PartTreeSettings(noise=7.0).noise == 7.0
        assert uses() == 1


def test_default_is_put_back_after_a_failure(bench: ModuleType) -> None:
    changed: list[tuple[int, int]] = []

    def fails() -> None:
        with bench.varied(named(bench, "registration/deformation.FitSettings.searches"), 6):
            changed.append((FitSettings(*REQUIRED).searches, FitSettings(*REQUIRED, 5).searches))
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        fails()
    assert changed == [(6, 5)]
    assert (PartTreeSettings().noise, FitSettings(*REQUIRED).searches) == (0.001, 3)


def test_varied_setting_changes_results_and_computes_nothing_before_them(bench: ModuleType, tmp_path: Path) -> None:
    body = bench.Body("starfish", 2, 400, 0)

    def run() -> dict[str, int]:
        outcome = bench.outcome(body, tmp_path, until="extrema")
        assert outcome.why == ""
        return dict(outcome.ran)

    def peaks() -> int:
        return len(bench.pipeline(body, tmp_path).artifact("extrema", frame=0).peaks)

    assert run() == {"mesh": 2, "geodesics": 2, "extrema": 2}
    default = peaks()
    with bench.varied(named(bench, "topology/extrema.ExtremaSettings.least_peak"), 0.999) as uses:
        assert run() == {"extrema": 2}
        assert uses() >= 2
        assert 0 < peaks() < default
    assert ExtremaSettings().least_peak == 0.02
    assert run() == {}, "the results of the defaults are still there and are not those of the variation"
    assert peaks() == default


def test_task_that_a_setting_cannot_change_keeps_its_code_digest(bench: ModuleType) -> None:
    asked = {
        "stiffness": ("kinetree.tasks.registration.stiffness", 0),
        "first_tree": ("kinetree.tasks.structure.first_tree", 1),
    }
    before = {name: freshness.code_digest(module, name) for name, (module, _) in asked.items()}
    with bench.varied(named(bench, "structure/part_tree.PartTreeSettings.noise"), 0.5):
        for name, (module, changes) in asked.items():
            assert (freshness.code_digest(module, name) != before[name]) == bool(changes)
            assert execute.code_digest(module, name) == freshness.code_digest(module, name)
        mine = freshness.code_digest(asked["first_tree"][0], "first_tree")
    with bench.varied(named(bench, "structure/part_tree.PartTreeSettings.noise"), 0.25):
        assert freshness.code_digest(asked["first_tree"][0], "first_tree") != mine
    assert {name: freshness.code_digest(module, name) for name, (module, _) in asked.items()} == before


def test_movement_pairs_joints_whatever_their_order(bench: ModuleType) -> None:
    def outcome(joints: np.ndarray) -> Any:
        return bench.Outcome(0, 0, math.nan, 0, joints, {})

    X = np.random.default_rng(0).normal(size=(4, 6, 3))
    moved = X[:, ::-1].copy()
    moved[2, 1, 0] += 0.03
    assert bench.movement(outcome(X), outcome(X[:, ::-1])) == (0, 0.0)
    assert bench.movement(outcome(X), outcome(moved)) == (0, pytest.approx(3.0))
    assert bench.movement(outcome(X), outcome(X[:, 1:])) == (1, 0.0)
    assert bench.movement(outcome(X[:, :0]), outcome(X)) == (6, 0.0)


def test_rows_are_sorted_by_effect_and_say_what_was_not_varied(bench: ModuleType) -> None:
    still = np.zeros((1, 1, 3))
    body, default = bench.Body("none", 1, 1, 0), bench.Outcome(1, 1, 0.5, 0, still, {})

    def row(name: str, half: Any, double: Any) -> Any:
        return bench.Row(
            bench.Setting("field", "kinetree.tasks.numerics.structure.m", "C", name, 1.0, ""), body, default, half, double
        )

    rows = [
        row("idle", default, default),
        row("half", default, "twice that is no share"),
        row("fixed", "because", "because"),
        row("judged", default, default._replace(spurious=1, joints=still + 0.05)),
        row("moved", default, default._replace(joints=still + 0.1)),
        row("lost", default, default._replace(joints=still[:, :0], found=0)),
        row("broken", default, default._replace(why="it broke")),
    ]
    order = [group[0].setting.field for group in bench.by_setting(rows)]
    assert order == ["broken", "judged", "lost", "moved", "idle", "half", "fixed"]
    text = bench.markdown(rows, ["structure/m.C.late on none"])
    assert "moved no joint at all (1):\n\n- structure/m.C.idle\n" in text
    assert "not both, moved no joint at all (1):\n\n- structure/m.C.half\n" in text
    assert "Not varied (1):\n\n- structure/m.C.fixed: because\n" in text
    assert "Not measured (1):\n\n- structure/m.C.late on none\n" in text
    assert "failed: it broke" in text


def test_rows_are_read_back_where_an_earlier_call_left_them(bench: ModuleType, tmp_path: Path) -> None:
    joints = np.random.default_rng(0).normal(size=(3, 4, 3))
    setting, body = named(bench, "structure/part_tree.PartTreeSettings.noise"), bench.Body("none", 3, 1, 0)
    found = bench.Outcome(4, 5, math.nan, 1, joints, {"skeleton": 1}, 2)
    row = bench.Row(setting, body, found, "never asked for", found._replace(joints=joints[:, :0], why="it broke"))
    file = tmp_path / "rows.jsonl"
    file.write_text(bench.line(row) + "\n")
    (again,) = bench.stored(file, [setting], [body])
    np.testing.assert_array_equal(again.default.joints, joints)
    assert (again.half, again.double.why, again.double.joints.shape) == ("never asked for", "it broke", (3, 0, 3))
    assert bench.stored(file, [setting._replace(default=7.0)], [body]) == [], "another default is another setting"
    assert bench.stored(file, [setting], [body._replace(seed=1)]) == []
    done = list(bench.measure([body], [setting], tmp_path, 1, math.inf))
    assert [one.setting for one in done] == [setting], "nothing is measured again"


def test_constants_that_are_fixed_when_compiled_or_imported_are_told_apart(bench: ModuleType) -> None:
    every = {setting.name: setting for setting in bench.constants()}
    assert bench.fixed_uses(every["registration/correspondence._STEPS"]) == ["correspondence.local_matches"]
    slender = every["structure/rotation_centres.SLENDER"]
    assert bench.fixed_uses(slender) == []
    with bench.varied(slender, 0.3):
        assert rotation_centres.SLENDER == 0.3
    assert slender.default == rotation_centres.SLENDER
