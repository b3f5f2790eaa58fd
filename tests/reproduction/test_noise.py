"""Figure 21: a row for every method and noise, a gap where a method fails, noise on a given sequence."""

import io
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh
from results.rigged_bodies import spider
from results.sample_report import judged
from shapes import sphere

from kinetree.errors import NodesFailedError
from kinetree.tasks.reproduction.noise import SIGMAS, figure_21, noisy_ply
from kinetree.tasks.reproduction.sequence import Run, Sequence


class Answered(Sequence):
    """A sequence whose runs all leave the same evaluation; the paper's method fails on the strongest noise."""

    def run(self, preset: str, *changes: str, until: tuple[str, ...] = (), beside: str = "") -> Run:
        if preset == "paper-2014" and changes == (f"source.synth.noise={SIGMAS[-1] / 1500:.6f}",):
            raise NodesFailedError("leaves: none")

        class Answer:
            def fetch(self, name: str) -> Any:
                return judged(spider())

        return Answer()  # type: ignore[return-value]


def test_every_method_and_noise_has_a_row_and_a_failure_is_a_gap(tmp_path: Path) -> None:
    told: list[str] = []
    _, table = figure_21(Answered(tmp_path, tell=told.append))
    assert [(row[0], row[2]) for row in table.rows] == [(s, p) for p in ("paper-2014", "default") for s in SIGMAS]
    summary = judged(spider()).summary
    assert summary is not None
    expected = (summary.scored, summary.found, summary.spurious, summary.percent)
    gap = table.rows[len(SIGMAS) - 1]
    assert gap[3:] == (None,) * 4
    assert all(row[3:] == expected for row in table.rows if row is not gap)
    assert told == ["leaves: none"]


def test_noise_on_a_mesh_is_along_its_normals_and_as_strong_as_told() -> None:
    V, F = sphere(4)
    read = trimesh.load(io.BytesIO(noisy_ply(V, F, 0.01, 3)), file_type="ply", process=False)
    assert np.array_equal(read.faces, F)
    step = read.vertices - V
    along = np.einsum("vx,vx->v", step, V)
    assert along.std() == pytest.approx(0.01, rel=0.1)
    assert np.abs(np.linalg.norm(step, axis=1) - np.abs(along)).max() < 1e-3
    assert noisy_ply(V, F, 0.01, 3) != noisy_ply(V, F, 0.01, 4)


def test_given_sequence_is_written_with_noise_and_keeps_frames_rate_and_truth(tmp_path: Path) -> None:
    V, F = sphere(2)
    asked: list[Sequence] = []

    class Given(Sequence):
        def run(self, preset: str, *changes: str, until: tuple[str, ...] = (), beside: str = "") -> Run:
            asked.append(self)

            class Answer:
                frames = (3, 7)

                def fetch(self, name: str, **index: int) -> Any:
                    mesh = SimpleNamespace(vertices=V, faces=F)
                    told = SimpleNamespace(fps=25.0, unit=None)
                    return {"mesh": mesh, "sequence": told, "evaluation": judged(spider())}[name]

            return Answer()  # type: ignore[return-value]

    figure_21(Given(tmp_path, Path("walk"), Path("truth.json"), ("source.frames=3:8:4", "geodesics.bases=50")))
    noisy = [one for one in asked if one.input != Path("walk")]
    assert {one.input for one in noisy} == {tmp_path / "noise-1", tmp_path / "noise-2"}
    assert {one.truth for one in noisy} == {Path("truth.json")}
    assert {one.sets for one in noisy} == {("geodesics.bases=50", "sequence.fps=25.0")}
    assert sorted(path.name for path in (tmp_path / "noise-2").iterdir()) == ["frame_000003.ply", "frame_000007.ply"]
