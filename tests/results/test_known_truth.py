"""The truth of a sequence: which frames are compared, and where the truth of a generated body comes from."""

import pytest
from results.true_skeletons import generated, observed

from kinetree.errors import InputError
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.known_truth import KnownTruth
from kinetree.schemas.results.truth import Truth
from kinetree.tasks.results.known_truth import known_truth
from kinetree.tasks.results.truth import synthetic, truth

RECIPE = generated(frames=3, vertices=300)
TRUTH, SOURCE = synthetic(RECIPE), observed(RECIPE)[0]
NOBODY = truth.function(params=truth.params(), files=None)
SILENT = {t: told.model_copy(update={"recipe": ""}) for t, told in SOURCE.items()}


def known(true: Truth, source: dict = SOURCE, unit: str | None = "mm") -> KnownTruth:
    return known_truth(true, source, Sequence(frames=tuple(source), fps=None, unit=unit))


def test_a_generated_body_brings_its_truth_and_others_need_a_file() -> None:
    assert known(NOBODY).source == "synth"
    assert Truth(**{k: v for k, v in {**known(NOBODY).plain(), **known(NOBODY).arrays()}.items() if k != "compared"}) == TRUTH
    assert (known(NOBODY, SILENT).names, known(NOBODY, SILENT).compared) == ((), ())


def test_frames_that_both_have_are_compared() -> None:
    shorter = {t: told for t, told in SOURCE.items() if t > 0}
    assert known(TRUTH, shorter).compared == (1, 2)
    made = known(TRUTH)
    assert made.members("true", ()) == (0, 1, 2)
    assert made.members("true/frame", (2,)) == (2,)


def test_units_that_cannot_be_compared_are_refused_before_any_frame_is() -> None:
    with pytest.raises(InputError, match="synth is in ell and the sequence in mm, but 'ell' cannot be converted"):
        known(TRUTH.model_copy(update={"unit": "ell"}))
