"""How good a result is against the truth, by the measures of both papers and of rigging papers."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import FRAME, JOINT


class EvaluationParams(Params):
    """When a true joint counts as found."""

    found: float = Field(default=0.05, gt=0, le=1)
    """Largest mean distance over the frames at which a true joint counts as found, share of the body's height."""
    close: float = Field(default=0.025, gt=0, le=1)
    """The same for a joint that counts as found closely."""


class JointScore(Params):
    """One true joint, or tip of a limb, and its partner in the result."""

    name: str = ""
    """Its name in the truth."""
    kind: str = "joint"
    """joint, or tip: the end of a bone."""
    scored: bool = False
    """Whether a result should have it, because it turns enough."""
    turns: float | None = None
    """Range of its angle over the clip, degrees; None where the truth does not have it."""
    found: str | None = None
    """Name of its partner in the result; None where no joint is within the limit."""
    mean: float | None = None
    """Mean distance from its partner over the frames, length."""
    deviation: float | None = None
    """Standard deviation of that distance over the frames, length."""
    worst: float | None = None
    """Largest distance in any frame, length."""
    percent: float | None = None
    """Mean distance, % of the height."""
    nearest: float | None = None
    """Mean distance of the nearest joint of a suitable kind, even if that is another joint's partner, % of the height."""


class Chamfer(Params):
    """Symmetric Chamfer distances between two skeletons, % of the side of the cube into which the body fits (RigNet 2020)."""

    j2j: float = 0.0
    """Between joints."""
    j2b: float = 0.0
    """Between joints and bones."""
    b2b: float = 0.0
    """Between bones."""


class Overlap(Params):
    """Pairs of a Hungarian matching that are nearer than half the body's local diameter (RigNet 2020)."""

    iou: float = 0.0
    """Twice the pairs divided by the joints of both skeletons, %."""
    precision: float = 0.0
    """Pairs divided by the joints of the result, %."""
    recall: float = 0.0
    """Pairs divided by true joints, %."""


class PartScore(Params):
    """How the parts agree with the true ones, over the vertices of all frames."""

    rand: float = 0.0
    """Rand index: share of pairs of vertices on which both agree, 0 to 1."""
    adjusted_rand: float = 0.0
    """Adjusted Rand index: the same corrected for chance, 0 expected of random labels."""
    mean_iou: float = 0.0
    """Mean over the true parts of the intersection over union with their partners."""
    parts: int = 0
    """Number of parts of the result."""
    true_parts: int = 0
    """Number of true parts."""


class Summary(Params):
    """Counts and means over the sequence."""

    scored: int = 0
    """True joints that the result should have."""
    found: int = 0
    """Scored joints found."""
    close: int = 0
    """Scored joints found closely."""
    missing: int = 0
    """Scored joints not found."""
    spurious: int = 0
    """Joints of the result that are no true joint."""
    branch_duplicates: int = 0
    """Spurious joints within the limit of a true joint that is found already and that several bones hang on."""
    duplicates: int = 0
    """Spurious joints within the limit of another true joint that is found already."""
    false: int = 0
    """Spurious joints with no such joint near them."""
    excused: int = 0
    """Joints of the result that are a true joint which is not scored."""
    tips: int = 0
    """True tips of limbs."""
    tips_found: int = 0
    """True tips found."""
    tip_percent: float | None = None
    """Mean distance of the tips that are found, % of the height; None where none is."""
    error: float | None = None
    """Mean distance of the scored joints that are found, length; None where none is."""
    percent: float | None = None
    """The same, % of the height."""
    deviation: float | None = None
    """Standard deviation over the frames, averaged over these joints, length."""
    detection: float = 0.0
    """R_detection (2009, Eq. 8), averaged over the frames."""
    distance: float = 0.0
    """E_dist (2009, Eq. 9), averaged over the frames, share of the height."""
    chamfer: Chamfer = Chamfer()
    """Against all joints of the truth."""
    chamfer_moving: Chamfer = Chamfer()
    """Against the root, the tips and the scored joints."""
    overlap: Overlap = Overlap()
    """Against all joints of the truth."""
    overlap_moving: Overlap = Overlap()
    """Against the root, the tips and the scored joints."""
    tree_edit: int = 0
    """Joints to remove and to insert until the tree is the true one, joints being identified by the matching."""
    tree_shape: int = 0
    """The same by the shape of the trees alone, without the matching (Zhang 1996)."""
    parts: PartScore | None = None
    """Agreement of the parts; None where the true parts are not known."""
    length_variation: float = 0.0
    """Largest standard deviation of a bone's length over the frames, % of the length."""
    true_length_variation: float = 0.0
    """The same of the true skeleton."""
    jitter: float | None = None
    """Root mean square of the error's second differences divided by that of the truth; None where the truth does not move."""
    jitter_percent: float = 0.0
    """Root mean square of the error's second differences, % of the height a frame²."""


class Evaluation(Artifact):
    """A skeleton compared with the truth; empty where no truth is given."""

    truth: str
    """Name of the truth's file; synth for a generated sequence; empty where there is no truth."""
    frames: tuple[int, ...]
    """Source frame numbers of the compared frames, ascending."""
    true_frames: int
    """Number of frames of the truth."""
    unit: str | None
    """Unit of all lengths; None where it is not known."""
    height: float
    """Height of the body, of which errors are shares, length; 0 where there is no truth."""
    joints: tuple[JointScore, ...]
    """All true joints and tips."""
    spurious: tuple[str, ...]
    """Names of the joints of the result that are no true joint."""
    duplicate_of: tuple[str, ...] = ()
    """Per spurious joint, the true joint beside it that is found already; empty where it stands for itself."""
    summary: Summary | None
    """Counts and means; None where there is no truth."""
    error: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length", finite=False)]
    """Distance of each true joint from its partner; NaN where it has none."""
    detection: Annotated[Floats, Array("float64", FRAME)]
    """R_detection of each frame (2009, Eq. 8)."""
    distance: Annotated[Floats, Array("float64", FRAME)]
    """E_dist of each frame as a share of the height (2009, Eq. 9)."""
