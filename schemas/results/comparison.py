"""Two runs of the same sequence compared: what each found, where they agree, and in which parameters they differ."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import FRAME, JOINT, PAIR


class ComparedRun(Params):
    """One of the two runs."""

    name: str = ""
    """How the run was named, such as its output folder."""
    method: str = ""
    """The method it ran."""
    joints: int = 0
    """Joints of its skeleton, without root and leaves."""
    leaves: int = 0
    """Leaves of its skeleton."""
    bones: int = 0
    """Bones of its skeleton."""
    frames: int = 0
    """Frames of the sequence."""
    seconds: float = 0.0
    """Seconds that computing the skeleton and all it is made from took, all nodes added up."""
    scored: int | None = None
    """True joints that the run should have found; None where there is no truth."""
    found: int | None = None
    """Scored joints found; None where there is no truth."""
    spurious: int | None = None
    """Joints that are no true joint; None where there is no truth."""
    error: float | None = None
    """Mean distance of the scored joints it found, length; None where there are none."""
    percent: float | None = None
    """The same, % of the height."""
    common_percent: float | None = None
    """Mean distance of the scored joints that both runs found, % of the height; None where there are none."""


class ParameterDifference(Params):
    """A parameter that has another value in the one run than in the other."""

    key: str = ""
    """task.name, or method."""
    a: str | None = None
    """Its value in the first run as JSON; None where the method has no such parameter or leaves it at its default."""
    b: str | None = None
    """The same of the second run."""


class JointPair(Params):
    """A joint of the first run and the joint of the second that is the same."""

    a: str = ""
    """Its name in the first run."""
    b: str = ""
    """Its name in the second run."""
    kind: str = "joint"
    """root, joint or leaf."""
    mean: float = 0.0
    """Mean distance over the frames, length."""
    worst: float = 0.0
    """Largest distance in any frame, length."""
    percent: float = 0.0
    """Mean distance, % of the height."""


class UnpairedJoint(Params):
    """A joint that only one of the runs has."""

    name: str = ""
    """Its name in that run."""
    kind: str = "joint"
    """root, joint or leaf."""
    nearest: str | None = None
    """Name of the nearest joint of the same kind in the other run; None where it has none."""
    percent: float | None = None
    """Mean distance of that joint, % of the height."""


class TrueJoint(Params):
    """A true joint, and what each run found of it."""

    name: str = ""
    """Its name in the truth."""
    kind: str = "joint"
    """joint, or tip: the end of a bone."""
    scored: bool = False
    """Whether a run should have found it, because it turns enough."""
    turns: float | None = None
    """Range of its angle over the clip, degrees; None where the truth does not have it."""
    a: str | None = None
    """Name of the joint of the first run that is this joint; None where it is missing."""
    b: str | None = None
    """The same of the second run."""
    percent_a: float | None = None
    """Mean distance of that joint in the first run, % of the height; None where it is missing."""
    percent_b: float | None = None
    """The same in the second run."""


class Comparison(Artifact):
    """Two skeletons of the same sequence."""

    a: ComparedRun
    """The first run."""
    b: ComparedRun
    """The second run."""
    frames: tuple[int, ...]
    """Source frame numbers, ascending; the same in both runs."""
    unit: str | None
    """Unit of all lengths; None where it is not known."""
    height: float
    """Length of which distances are shares: the height in the truth, or the mean of both bodies' longest sides."""
    limit: float
    """Largest mean distance over the frames of two joints that are the same, share of the height."""
    truth: str
    """Name of the truth's file; synth for a generated sequence; empty where there is no truth."""
    parameters: tuple[ParameterDifference, ...]
    """Parameters with different values."""
    pairs: tuple[JointPair, ...]
    """Joints that both runs have: each is the nearest of its kind to the other, and not beyond the limit."""
    only_a: tuple[UnpairedJoint, ...]
    """Joints that only the first run has."""
    only_b: tuple[UnpairedJoint, ...]
    """Joints that only the second run has."""
    mean_percent: float | None
    """Mean distance of the paired joints, without root and leaves, % of the height; None where no joint is paired."""
    true_joints: tuple[TrueJoint, ...]
    """True joints and tips; none where there is no truth."""
    distance: Annotated[Floats, Array("float64", FRAME, PAIR, unit="length")]
    """Distance of the two joints of each pair."""
    error_a: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length", finite=False)]
    """Distance of each true joint from its partner in the first run; NaN where it is missing."""
    error_b: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length", finite=False)]
    """The same in the second run."""
