"""Whether a result can be relied on, and what speaks against it (ours)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Ints, Params
from kinetree.schemas.dims import FRAME, JOINT

Level = Literal["good", "except", "unusable"]
Kind = Literal[
    "rigid",
    "unexplained",
    "lost",
    "off",
    "outside",
    "uncertain",
    "weak",
    "imprecise",
    "asymmetric",
    "small",
    "shape",
    "narrowing",
    "mirror",
    "close",
    "short",
    "still",
    "unpaired",
]


class Finding(Params):
    """One thing that a person should know before relying on the result."""

    kind: Kind
    """What it is about, in the body, in frames, or at joints, as said here.

    rigid       : nothing turns, so there are no joints
    unexplained : the skinned mesh is far from the input in most frames
    lost        : something is wrong in too many frames
    off         : parts are away from the input, or the alignment failed
    outside     : joints lie outside the body
    uncertain   : a joint is hidden in some frames, or its part does not fit there
    weak        : joints that few frames support
    imprecise   : joints whose expected error, or its bound, is large
    asymmetric  : bones of left and right differ in length
    short       : few frames
    still       : no joint turns enough
    unpaired    : joints found on one side alone
    small       : joints that turn little
    shape       : joints that the body's shape alone shows, so that no turn was measured there
    narrowing   : joints that a narrowing of their limb alone shows, and no motion
    mirror      : joints that the mirror image of their limb alone shows, and no motion
    close       : joints very near the one that they hang on.
    """
    severity: Literal["grave", "fault", "note"]
    """grave: do not use the result; fault: do not use what is named; note: good to know."""
    frames: tuple[int, ...] = ()
    """Source frame numbers, ascending; empty where it is said of all."""
    joints: tuple[str, ...] = ()
    """The skeleton's names; empty where it is said of the whole body. asymmetric: left and right in turn."""
    amount: float = 0.0
    """How much, at worst. off, outside, unexplained, asymmetric, close: share of the diagonal of the body's box; lost: of the
    frames; imprecise: share of the body's longest side; uncertain, weak: least mean confidence; small, still: greatest range
    in degrees; short: frames."""
    bounds: tuple[float, ...] = ()
    """imprecise: of each joint, the distance that the mean error of nine joints of ten keeps, share of the body's longest
    side."""


class Verdict(Artifact):
    """Whether the result can be relied on."""

    level: Level
    """good; except: good but for what the faults name; unusable: do not use it."""
    findings: tuple[Finding, ...]
    """The most serious first."""
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    joints: tuple[str, ...]
    """The skeleton's names."""
    labels: tuple[str, ...]
    """What people call each joint, such as left knee; the skeleton's name where nothing was recognised."""
    worst: float
    """Largest root mean square distance between a part and the input in any frame, share of the diagonal of the body's box."""
    state: Annotated[Ints, Array("int32", FRAME, JOINT)]
    """Of every joint and its part in every frame: 0 trusted, 1 uncertain, 2 wrong."""
