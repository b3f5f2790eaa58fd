"""The rigid parts that a cut in another pose of the body gives (ours)."""

from typing import Annotated

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import FRAME, JOINT, PART, ROW, VERTEX, XYZ


class FurtherCut(Artifact):
    """Rigid parts as in RigidParts, but cut in the aligned pose of another frame, from which their motions start."""

    frame: int
    """Source frame number of that pose."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """Part of every vertex of the reference mesh."""
    rotation: Annotated[Floats, Array("float64", FRAME, PART, ROW, XYZ)]
    """Of every part from that pose to each frame."""
    translation: Annotated[Floats, Array("float64", FRAME, PART, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v in that pose."""
    residual: Annotated[Floats, Array("float64", FRAME, PART, unit="length")]
    """Root mean square distance between the part's clearly rigid vertices and where its motion carries them."""
    joined: bool
    """Whether its joints are known; where the frames give the correspondence they depend on the first cut."""
    joints: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """Its joints in every frame, but for its root; none where they are not known."""
