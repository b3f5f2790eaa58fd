"""Figure 21: a row for every method and noise, a gap where a method fails, and no noise on a given sequence."""

from pathlib import Path
from typing import Any

import pytest
from results.rigged_bodies import spider
from results.sample_report import judged

from kinetree.errors import InputError, NodesFailedError
from kinetree.tasks.reproduction.noise import SIGMAS, figure_21
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


def test_noise_on_a_given_sequence_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="walk: Figure 21 adds noise to the generated body; leave out --input"):
        figure_21(Sequence(tmp_path, Path("walk")))
