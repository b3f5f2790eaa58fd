"""An initial model deformed to the graph of another frame (2009, Sec. 2.3.1, Eqs. 2 to 4)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import NODE, ROW, VERTEX, XYZ


class GraphDeformationParams(Params):
    """Forces, and what follows them; lengths are shares of the root of the area."""

    sigma: float = Field(default=0.05, gt=0)
    """σ of Eq. 3: distance over which the drift of a node is felt."""
    stiffness: float = Field(default=1.0, ge=0)
    """k of Eq. 4 for nodes that are joined; nodes two hops apart have half of it."""
    anchor: float = Field(default=0.02, ge=0)
    """k′ of Eq. 4."""
    step: float = Field(default=1.0, gt=0)
    """Time step of the backward Euler method."""
    steps: int = Field(default=40, ge=1, le=10_000)
    """Most steps."""
    rest_length: bool = True
    """Whether internal forces keep distances as they are in the initial model; Eq. 4 as it stands shortens all of them."""
    centred: bool = True
    """Whether k′ pulls a node to where it was before; Eq. 4 as it stands pulls it to the origin of the coordinates."""
    branches: bool = True
    """Whether nodes drift to the point of the same limb that is as far from its leaf; the paper has the nearest node."""
    surface: bool = True
    """Whether the model's surface is then fitted to the frame's, which keeps nodes inside (the volumetric fit of Sec. 3.2)."""
    hold: float = Field(default=0.02, ge=0)
    """How firmly nodes keep their rotation against each other in the fit to the surface."""
    samples: int = Field(default=3000, ge=100)
    """Vertices that stand for a frame's surface in that fit."""


class GraphDeformation(Artifact):
    """Where the model is in one frame, and how well its surface lies on the frame's."""

    structure: int
    """The structure whose initial model it is."""
    position: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """Position of every node."""
    rotation: Annotated[Floats, Array("float64", NODE, ROW, XYZ)]
    """From the initial frame to this one, of every node."""
    vertices: Annotated[Floats, Array("float64", VERTEX, XYZ, unit="length")]
    """The initial frame's mesh in this frame."""
    residual: Annotated[Floats, Array("float64", VERTEX, unit="length")]
    """Distance of every vertex to the frame's surface."""
    stretch: Annotated[Floats, Array("float64", VERTEX)]
    """Length of the edges around every vertex against their length in the initial frame."""
    confidence: Annotated[Floats, Array("float64", VERTEX)]
    """Confidence of every vertex, 0 to 1."""
    uncovered: float
    """Share of the frame's surface that the model does not explain."""
    drifted: float
    """Mean distance between the nodes after the forces and the nearest nodes of the frame's graph, length."""
