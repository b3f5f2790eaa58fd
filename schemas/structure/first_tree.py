"""The tree of the first cut: which joints there are, and how far off its joints may be (2014, Sec. 6.3)."""

from typing import Annotated, Literal

from kinetree.schemas.array import Array, Artifact, Floats, Ints
from kinetree.schemas.dims import END, FRAME, JOINT, PAIR, PART, ROW, VERTEX, XYZ

Drop = tuple[int, Literal["flesh", "still", "sliding", "unevident", "unpaired", "alone", "midway", "smeared"]]
"""A part that was dropped, and why: flesh around a joint, turns too little, drifts more than it turns, the frames show no
joint, the mirror image of its limb has none there, no other cut has it and it is not needed, its joint lay midway between two
that the frames show, or, at the end of a limb, close to the joint before, where they show another without it."""


class JointTree(Artifact):
    """The rigid parts in one tree, each with the joint about which it turns, a part after its parent.

    "part" are the parts as the cut numbers them, RigidParts or one in another pose; "joint" those of the tree.
    """

    frames: tuple[int, ...]
    """Source frame number of every frame, ascending."""
    parents: tuple[int, ...]
    """Parent of every joint, −1 for the root, which is the first."""
    place: Annotated[Ints, Array("int32", PART)]
    """Joint about which each part turns; −1 for parts that were dropped."""
    followed: bool
    """Whether every vertex was followed with certainty."""
    label: Annotated[Ints, Array("int32", VERTEX)]
    """Joint about which each vertex of the reference mesh turns."""
    skin: Annotated[Floats, Array("float64", VERTEX, JOINT)]
    """Skinning weights, not negative, summing to 1."""
    rotation: Annotated[Floats, Array("float64", FRAME, JOINT, ROW, XYZ)]
    """Of every joint's part from the reference mesh to each frame."""
    translation: Annotated[Floats, Array("float64", FRAME, JOINT, XYZ, unit="length")]
    """x(t) = rotation · v + translation for a vertex v of the reference mesh."""
    certain_share: Annotated[Floats, Array("float64", FRAME, JOINT)]
    """Share of the surface of every joint's part that is certain in each frame."""
    rest: Annotated[Floats, Array("float64", JOINT, XYZ, unit="length")]
    """Position of every joint in the reference mesh, as this cut has it."""
    drift: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Root mean square distance between the joint as one of its parts and as the other carries it; 0 for the root."""
    unexplained: Annotated[Floats, Array("float64", FRAME, JOINT, unit="length")]
    """Root mean square of what the motion of every joint's part leaves unexplained."""
    radius: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Radius of the border between the joint's two parts; 0 for the root."""
    part: Annotated[Ints, Array("int32", VERTEX)]
    """Part of each vertex, before any was dropped."""
    pair: Annotated[Ints, Array("int32", PAIR, END)]
    """Parts that meet, before any was dropped."""
    centre: Annotated[Floats, Array("float64", PAIR, XYZ, unit="length")]
    """The point of the reference mesh that the two turn about best."""
    border_drift: Annotated[Floats, Array("float64", PAIR, unit="length")]
    """Root mean square distance between that point as one part and as the other carries it."""
    border_degrees: Annotated[Floats, Array("float64", PAIR, unit="°", finite=False)]
    """Range of their turning against each other; NaN for borders that the spanning tree of all parts does not have."""
    dropped: tuple[Drop, ...]
    """Parts that were dropped, in that order, and why."""


class FirstTree(JointTree):
    """The joints that the first cut shows."""
