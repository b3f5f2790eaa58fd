"""Every nasty sequence of `nasty.py` ends as it should: done, done with a word, without its bad frame, or refused in words."""

from pathlib import Path
from typing import Any

import pytest
from nasty import CASES, DROPPED, OK, REFUSED, REMARK, SPOILT, Case

from kinetree.errors import InputError
from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence


def ran(folder: Path, case: Case) -> tuple[Sequence, list[str], Pipeline]:
    """The frames and remarks of a run up to the connectivity; raises what the user would be told."""
    told = {"source": {"input": str(case.write(folder))}, "output": str(folder / "out"), "compute": {"executor": "sync"}}
    pipeline = Pipeline.of(told)
    assert pipeline.run(until=["connectivity"])["failures"] == []
    made: Any = pipeline.artifact("sequence")
    return made, [text for _, text in pipeline.remarks() if not text.startswith("fixed connectivity")], pipeline


def counted(mesh: Mesh) -> dict[str, int]:
    """What cleaning counted, and what it left."""
    return {**mesh.cleaning.model_dump(), "vertices": len(mesh.vertices), "faces": len(mesh.faces)}


def test_outcomes_other_than_done_are_in_words() -> None:
    assert len(CASES) >= 60
    assert [name for name, case in CASES.items() if bool(case.words) == (case.outcome == OK)] == []


@pytest.mark.parametrize("name", CASES)
def test_nasty_sequence_ends_as_it_should(name: str, tmp_path: Path) -> None:
    case = CASES[name]
    if case.outcome == REFUSED:
        with pytest.raises(InputError) as refusal:
            ran(tmp_path, case)
        assert case.words in str(refusal.value)
        assert not (tmp_path / "out").exists()
        return
    sequence, remarks, pipeline = ran(tmp_path, case)
    dropped = {bad.frame: bad.reason for bad in sequence.dropped}
    if case.outcome == DROPPED:
        assert sequence.frames == tuple(t for t in case.numbers if t != SPOILT)
        assert list(dropped) == [SPOILT]
        assert case.words in dropped[SPOILT]
        assert len(remarks) == 1
        assert dropped[SPOILT] in remarks[0]
        return
    assert (sequence.frames, dropped) == (case.numbers, {})
    assert [case.words in text for text in remarks] == [True] * (case.outcome == REMARK)
    mesh: Any = pipeline.artifact("mesh", frame=sequence.frames[min(SPOILT, len(sequence.frames) - 1)])
    assert {key: counted(mesh)[key] for key in case.counts} == case.counts
