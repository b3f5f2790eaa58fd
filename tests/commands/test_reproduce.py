"""`kinetree reproduce`: tables of both methods beside the paper's, and refusals in words."""

import csv
import json
from pathlib import Path

import pytest

from kinetree.errors import ConfigError
from kinetree.pipeline.inspect import Pipeline
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.reproduce import reproduce
from kinetree.tasks.reproduction.printed import TABLE_2

TINY = ["source.synth.frames=6", "source.synth.vertices=800", "source.synth.contacts=[]", "source.synth.connectivity=fixed"]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"paper": "2009"}, "2009: no such paper; tables and figures are made of 2014"),
        ({"paper": "2014", "table": [3]}, "--table 3: not made; there are 1, 2"),
        ({"paper": "2014", "figure": [5]}, "--figure 5: not made; there are 11, 19, 20, 21"),
    ],
)
def test_what_is_not_made_is_refused(tmp_path: Path, words: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError) as refused:
        reproduce(**words, output=tmp_path / "out")  # type: ignore[arg-type]
    assert str(refused.value) == message
    assert list(tmp_path.iterdir()) == []


def test_tables_stand_beside_the_papers_and_agree_with_the_runs(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "out"
    with APPLICATION.active():
        reproduce("2014", table=[1, 2], figure=[11, 19, 20], output=out, sets=TINY, as_json=True)
    costs, errors, areas, *_ = json.loads(capsys.readouterr().out)["tables"]
    assert [row["method"] for row in costs["rows"]] == ["printed"] * 3 + ["paper-2014", "default"]
    for row in costs["rows"][3:]:
        assert row["frames"] == 6
        assert row["edges"] == 3 * (row["vertices"] - 2)  # a closed surface without handles
        steps = [row[f"{step} s"] for step in ("macroscopic", "microscopic", "mesoscopic")]
        assert row["total s"] == pytest.approx(sum(steps))
    for number in (11, 19, 20):
        assert (out / f"figure-{number}.png").read_bytes().startswith(b"\x89PNG")
    most = max(row["clusters of the cones"] for row in areas["rows"])
    assert [row["clusters of the cones"] for row in areas["rows"] if row["chosen"] == "yes"] == [most]
    assert [row["joint"] for row in errors["rows"]] == list(TABLE_2)
    with APPLICATION.active():
        judged = Pipeline.of(str(out / "default")).artifact("evaluation")
    by_name = {row.name: row for row in judged.joints}
    for row, name in zip(errors["rows"], ("elbow_l", "elbow_r"), strict=False):
        assert row["default %"] == (by_name[name].percent if row["default found"] == "yes" else by_name[name].nearest)
    written = list(csv.DictReader((out / "table-2.csv").read_text().splitlines()))
    assert [float(row["printed %"]) for row in written] == [pytest.approx(100 * mean / 1500) for mean, _ in TABLE_2.values()]
