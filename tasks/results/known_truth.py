"""The truth that a sequence is compared with, whether a file told it or the recipe of a generated body."""

from collections.abc import Mapping

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.known_truth import KnownTruth
from kinetree.schemas.results.truth import Truth
from kinetree.tasks.numerics.results.units import unit_factor
from kinetree.tasks.results.truth import numbered, synthetic


@task()
def known_truth(truth: Truth, source: Mapping[int, Source], sequence: Sequence) -> KnownTruth:
    """Numbers the frames of the truth as the sequence's, and computes that of a generated body (ours)."""
    recipe = next((s.recipe for s in source.values()), "")
    if not truth.names and recipe:
        truth = synthetic(recipe)
    compared: tuple[int, ...] = ()
    if truth.names:
        truth = numbered(truth, source)
        unit_factor(truth.unit, sequence.unit, truth.source)  # refuses units that cannot be compared
        compared = tuple(sorted(set(truth.frames) & set(source)))
    return KnownTruth(**truth.plain(), **truth.arrays(), compared=compared)
