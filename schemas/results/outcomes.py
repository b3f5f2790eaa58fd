"""What became of the sequences of a data set."""

from typing import ClassVar

from kinetree.schemas.array import Artifact, Index, Params


class SequenceOutcome(Params):
    """What became of one sequence in its last run."""

    name: str
    """Of the sequence and of its output folder."""
    output: str = ""
    """The output folder, relative to that of the data set."""
    method: str = ""
    """The method that was asked for."""
    status: str = "new"
    """new, done, failed, interrupted or stopped."""
    seconds: float = 0.0
    """Seconds of computing of all its nodes, whichever run computed them."""
    remarks: tuple[str, ...] = ()
    """What its results have to say."""
    failures: tuple[str, ...] = ()
    """What went wrong."""
    files: tuple[str, ...] = ()
    """What lies in the output folder."""
    has_result: bool = False
    """Whether its skeleton and what belongs to it are there."""


class OutcomesParams(Params):
    """What the run over the data set tells."""

    sequences: tuple[SequenceOutcome, ...] = ()
    """All sequences in the order of their names."""


class Outcomes(Artifact):
    """What became of all sequences; those with a result are the members of the dimension `sequence`."""

    opens: ClassVar[tuple[str, ...]] = ("sequence",)
    sequences: tuple[SequenceOutcome, ...]
    """All sequences in the order of their names."""

    def members(self, space: str, index: Index) -> tuple[int, ...]:
        """Places, among all sequences, of those that have a result."""
        return tuple(place for place, sequence in enumerate(self.sequences) if sequence.has_result)
