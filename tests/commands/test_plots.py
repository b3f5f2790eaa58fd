"""Pictures: drawn whole or not at all."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from results.rigged_bodies import spider
from results.sample_derivation import parts_of, reference_of, tree_of
from results.sample_report import artifacts, judged, unjudged

from kinetree.errors import ConfigError, UnknownNodeError
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.commands import plot
from kinetree.tasks.results.plots import PLOTS, PLOTS_OF_METHOD, draw
from kinetree.tasks.results.plots.drawing import view
from kinetree.tasks.results.plots.motion import joint_angles

MAGIC = {".png": b"\x89PNG", ".svg": b"<?xml", ".pdf": b"%PDF"}


@pytest.fixture(scope="module")
def fetch() -> Any:
    body = spider()
    derived = {"reference": reference_of(body), "rigid_parts": parts_of(body), "kinematic_tree": tree_of(body)}
    stored = artifacts() | {"evaluation": judged(body)} | derived
    return lambda name, frame=None: stored[name] if frame is None else stored[name][frame]


def test_help_of_the_command_names_every_picture() -> None:
    assert sorted(set().union(*PLOTS_OF_METHOD.values())) == sorted(plot.WHAT)


def test_picture_of_a_step_that_a_method_does_not_have_is_refused(fetch: Any, tmp_path: Path) -> None:
    of_2014 = PLOTS_OF_METHOD["mesoscopic-2014"]
    assert set(PLOTS) - set(of_2014) == {"elimination"}
    with pytest.raises(ConfigError, match=r"plot 'elimination' is of method mesoscopic, and this run .*; its plots: .*merging"):
        draw("elimination", fetch, [0], tmp_path / "a.png", plots=of_2014)
    for what in ("clusters", "coherence", "description", "endoskeleton"):
        with pytest.raises(ConfigError, match=f"plot '{what}' is of method reeb or reeb-2009, and this run has another; its"):
            draw(what, fetch, [0], tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("what", sorted(PLOTS))
@pytest.mark.parametrize("ending", sorted(MAGIC))
def test_every_picture_is_drawn_in_every_format(fetch: Any, tmp_path: Path, what: str, ending: str) -> None:
    draw(what, fetch, [0, 6], tmp_path / f"a{ending}")
    assert [p.name for p in tmp_path.iterdir()] == [f"a{ending}"]
    assert (tmp_path / f"a{ending}").read_bytes().startswith(MAGIC[ending])


def test_unknown_picture_and_unknown_ending_are_refused_and_nothing_is_written(fetch: Any, tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="known plots: .*correlation, .*mu"):
        draw("skelton", fetch, [0], tmp_path / "a.png")
    with pytest.raises(ConfigError, match=r"pictures end in \.png"):
        draw("mu", fetch, [0], tmp_path / "a.gif")
    with pytest.raises(ConfigError, match="cannot be written"):
        draw("mu", fetch, [0], tmp_path / "missing" / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_a_pipe_is_not_replaced_by_a_picture(fetch: Any, tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "a.png")
    with pytest.raises(ConfigError, match="no file, and would be replaced by one"):
        draw("mu", fetch, [0], tmp_path / "a.png")
    assert (tmp_path / "a.png").is_fifo()


def test_errors_without_a_truth_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="this run has no truth"):
        draw("errors", lambda name: unjudged(spider()), [0], tmp_path / "a.png")
    assert list(tmp_path.iterdir()) == []


def test_words_from_outside_are_no_formulas(fetch: Any, tmp_path: Path) -> None:
    body = spider(unit=r"$\frac$", names=(r"$\bad{", *spider().names[1:]))
    draw("tree", lambda name, frame=None: body if name == "skeleton" else fetch(name, frame), [0], tmp_path / "a.svg")
    assert r"$\bad{" in (tmp_path / "a.svg").read_text()


@pytest.mark.parametrize("up", [0, 1, 2, ~0, ~1, ~2])
def test_direction_that_is_said_to_be_up_is_up(up: int) -> None:
    rng = np.random.default_rng(0)
    axes = view([rng.normal(size=(50, 3)) * [1, 2, 3]], up)
    assert np.array_equal(axes[:, 1], np.eye(3)[up] if up >= 0 else -np.eye(3)[~up])
    assert np.linalg.det(axes) == pytest.approx(1)


def test_turning_of_a_hinge_is_the_angle_it_was_turned_by() -> None:
    body = spider()
    arm = body.names.index("arm")
    angle = np.radians(np.linspace(0, 90, len(body.frames)))
    c, s, zero, one = np.cos(angle), np.sin(angle), 0 * angle, 0 * angle + 1
    rotation = np.array(body.rotation)
    rotation[:, arm] = rotation[:, 0] @ np.array([[c, -s, zero], [s, c, zero], [zero, zero, one]]).transpose(2, 0, 1)
    np.testing.assert_allclose(joint_angles(spider(rotation=rotation))[:, arm], np.degrees(angle), atol=1e-5)


def test_pictures_stand_as_the_run_says_and_else_along_y() -> None:
    def fetch(name: str) -> UpDirection:
        if name != "up_direction":
            raise UnknownNodeError(name)
        return UpDirection(up="-z", confidence=0.9)

    def nothing(name: str) -> UpDirection:
        raise UnknownNodeError(name)

    assert plot._axis(None, fetch) == ~2
    assert plot._axis("x", fetch) == 0
    assert plot._axis(None, nothing) == 1


def test_frames_are_four_across_the_sequence_or_those_named_or_all() -> None:
    known = list(range(10, 20))
    assert plot._wanted("", known) == [10, 13, 16, 19]
    assert plot._wanted("12, 15", known) == [12, 15]
    assert plot._wanted("all", known) == known
    with pytest.raises(ConfigError, match=r"^--frames 3: write all, or numbers of frames such as 0,12,30; there are 10 to 19$"):
        plot._wanted("3", known)
