"""How far off every joint is expected to be (ours)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import FRAME, JOINT

EvidenceKind = Literal["motion", "shape", "narrowing", "mirror"]
"""How a joint is known: its parts turn against each other; by the body's shape alone; by a narrowing of its limb alone; or by
the mirror image of its limb alone. The last three turn only in frames in which uncertain parts were fitted to the surface."""


class ErrorBars(Artifact):
    """The expected error of every joint, a bound, and the evidence for it; NaN for root and leaves, and where it is not known.

    The constants were fitted to generated bodies, whose truth is known. Methods other than the default have none.
    """

    joints: tuple[str, ...]
    """The skeleton's names."""
    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    cuts: int
    """Poses in which the body was cut; 0 where nothing is known."""
    expected: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Expected distance from the true joint, mean over the frames."""
    bound: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Distance that nine joints of ten keep, mean over the frames."""
    in_frame: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length", finite=False)]
    """Expected distance in every frame: larger where the pose is uncertain."""
    drift: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance between the joint as one of its parts and as the other carries it."""
    spread: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance of several cuts' joints from their mean; NaN also where no other cut has the joint."""
    residual: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square of what the motions of the joint's two parts leave unexplained."""
    surface_offset: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance from where halves of the frames' surfaces alone have it; NaN also where they do not say."""
    turning_resistance: Annotated[Floats, Array("float64", JOINT, finite=False)]
    """How firmly the surface of its parts resists turning about it: 0 where one is round about an axis through the joint, at
    most 1/3; NaN also where its parts have no vertices."""
    hinge_offset: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance, along its limb, from where halves of the frames' surfaces bend the limb; NaN also where no
    straight limb is on both sides."""
    turning_below: Annotated[Floats, Array("float64", JOINT, unit="°", finite=False)]
    """Range of turning of the joint right below that turns most; 0 where there is none."""
    softness: Annotated[Floats, Array("float64", JOINT, finite=False)]
    """How much of the skin near the joint follows other joints than the one that it follows most, 0 to 1."""
    asymmetry: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Difference between the lengths of the joint's bone and of that bone's mirror image; NaN also where it has none."""
    agreeing: Annotated[Ints, Array("int32", JOINT)]
    """Cuts that have the joint."""
    support: Annotated[Ints, Array("int32", JOINT)]
    """Frames in which most of the surface of the joint's parts was seen and certain."""
    evidence: tuple[EvidenceKind | None, ...]
    """How each joint is known; None for root and leaves, and where it is not known."""
