"""How good a result is against the truth, in the terms of both papers and of rigging papers."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import FRAME, JOINT


class EvaluationParams(Params):
    """What counts as found."""

    found: float = Field(default=0.05, gt=0, le=1)
    """Mean distance from the true joint, share of the height, up to which a joint is found."""
    close: float = Field(default=0.025, gt=0, le=1)
    """The same for a joint that is found closely."""


class JointScore(Params):
    """One true joint, or tip of a limb, and what was found of it."""

    name: str = ""
    """Its name in the truth."""
    kind: str = "joint"
    """joint or tip."""
    scored: bool = False
    """Whether it turns enough to be asked for."""
    turns: float | None = None
    """Degrees that it turns over the clip; None where the truth does not say."""
    found: str | None = None
    """Name of the joint that was found there; None where there is none within the limit."""
    mean: float | None = None
    """Distance between the two, averaged over the frames, length."""
    deviation: float | None = None
    """Standard deviation of that distance over the frames, length."""
    worst: float | None = None
    """Largest of the frames, length."""
    percent: float | None = None
    """The mean in % of the height."""
    nearest: float | None = None
    """Mean distance of the nearest joint that may be it, whoever's partner that is, % of the height."""


class Chamfer(Params):
    """Symmetric Chamfer distances between two skeletons, hundredths of the cube into which the body fits (RigNet 2020)."""

    j2j: float = 0.0
    """Between joints."""
    j2b: float = 0.0
    """Between joints and bones."""
    b2b: float = 0.0
    """Between bones."""


class Overlap(Params):
    """Joints nearer than half the body's local diameter to their partner of a Hungarian matching (RigNet 2020)."""

    iou: float = 0.0
    """Twice the pairs by all joints of both skeletons, %."""
    precision: float = 0.0
    """Pairs by joints found, %."""
    recall: float = 0.0
    """Pairs by true joints, %."""


class PartScore(Params):
    """How the parts agree with the true ones, over the vertices of all frames."""

    rand: float = 0.0
    """Share of pairs of vertices on which both agree, together or apart."""
    adjusted_rand: float = 0.0
    """The same, 0 where chance would have it."""
    mean_iou: float = 0.0
    """Intersection over union of each true part with its partner, averaged."""
    parts: int = 0
    """Parts found."""
    true_parts: int = 0
    """True parts."""


class Summary(Params):
    """The sequence in one line."""

    scored: int = 0
    """True joints that should be found."""
    found: int = 0
    """Of these, found."""
    close: int = 0
    """Of these, found closely."""
    missing: int = 0
    """Of these, not found."""
    spurious: int = 0
    """Joints found where there is none."""
    excused: int = 0
    """Joints found where the truth has one that is not asked for."""
    tips: int = 0
    """True tips of limbs."""
    tips_found: int = 0
    """Of these, found."""
    error: float | None = None
    """Mean distance of the scored joints found, length; None where none is."""
    percent: float | None = None
    """The same in % of the height."""
    deviation: float | None = None
    """Standard deviation over the frames, averaged over these joints, length."""
    detection: float = 0.0
    """R_detection (2009, Eq. 8), averaged over the frames."""
    distance: float = 0.0
    """E_dist (2009, Eq. 9), averaged over the frames, share of the height."""
    chamfer: Chamfer = Chamfer()
    """Against all joints of the truth."""
    chamfer_moving: Chamfer = Chamfer()
    """Against root, tips and the joints that are scored."""
    overlap: Overlap = Overlap()
    """Against all joints of the truth."""
    overlap_moving: Overlap = Overlap()
    """Against root, tips and the joints that are scored."""
    tree_edit: int = 0
    """Joints to remove and to put in until the tree is the true one, a joint being the one it was matched with."""
    tree_shape: int = 0
    """The same by the shape of both trees alone, wherever their joints are (after Zhang 1996)."""
    parts: PartScore | None = None
    """Agreement of the parts; None where the true parts are not known."""
    length_variation: float = 0.0
    """Largest standard deviation of a bone's length over the frames, % of the length."""
    true_length_variation: float = 0.0
    """The same of the true skeleton."""
    jitter: float | None = None
    """Second differences of the error by those of the truth, root mean square; None where the truth stands still."""
    jitter_percent: float = 0.0
    """Second differences of the error, root mean square, % of the height."""


class Evaluation(Artifact):
    """A skeleton against the truth; empty where no truth is given."""

    truth: str
    """Name of the truth's file, or synth; empty where there is none."""
    frames: tuple[int, ...]
    """Source frame numbers of the frames compared, ascending."""
    true_frames: int
    """How many frames the truth has."""
    unit: str | None
    """Unit of all lengths; None where nobody knows."""
    height: float
    """What errors are a share of, length; 0 where there is no truth."""
    joints: tuple[JointScore, ...]
    """Every true joint and tip."""
    spurious: tuple[str, ...]
    """Names of joints found where there is none."""
    summary: Summary | None
    """All of it in one line; None where there is no truth."""
    error: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length", finite=False)]
    """Distance of each true joint from its partner in each frame; NaN where it has none."""
    detection: Annotated[Floats, Array("float64", FRAME)]
    """R_detection of each frame (2009, Eq. 8)."""
    distance: Annotated[Floats, Array("float64", FRAME)]
    """E_dist of each frame as a share of the height (2009, Eq. 9)."""
