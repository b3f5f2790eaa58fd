"""What the joints were found from, for people to look at (2014, Figs. 7, 11 and 15)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Bools, Floats, Ints, Params
from kinetree.schemas.dims import ANNULUS, CONE, END, JOINT, PAIR, PART, VERTEX, XYZ


class TracesParams(Params):
    """How cones are drawn."""

    rings: int = Field(default=50, ge=4, le=1000)
    """Rings in the longest distance from each leaf; what was cut is seen where this is the same as for the parts."""


class Traces(Artifact):
    """Cones and annuli on the reference mesh, how ill they merge, the graph of parts before pruning, bones before fixing."""

    threshold: float
    """Merge error from which on two tenths of a cone are worth a cut, share of the root of the area."""
    tips: Annotated[Ints, Array("int32", CONE)]
    """Vertex of the reference mesh around which each cone lies."""
    ring: Annotated[Ints, Array("int32", CONE, VERTEX)]
    """Annulus of every vertex in each cone, 0 around the tip, −1 beyond; cones may overlap."""
    run: Annotated[Ints, Array("int32", CONE, ANNULUS)]
    """Rigid run that each annulus is in after the first, too fine cut; −1 beyond the cone's last annulus."""
    merge: Annotated[Floats, Array("float64", CONE, ANNULUS, finite=False)]
    """Merge error at each annulus' far border, share of the root of the area; NaN from the cone's last annulus on."""
    joint_of_annulus: Annotated[Ints, Array("int32", CONE, ANNULUS)]
    """Joint whose part most of an annulus is in the end; −1 beyond the cone's last annulus."""
    pair: Annotated[Ints, Array("int32", PAIR, END)]
    """Parts that meet, before any was dropped; parts are numbered as they were found."""
    rest: Annotated[Floats, Array("float64", PAIR, XYZ, unit="length")]
    """The point of the reference mesh that the two turn about best."""
    drift: Annotated[Floats, Array("float64", PAIR, unit="length")]
    """By what the two disagree on where that point goes, root mean square."""
    degrees: Annotated[Floats, Array("float64", PAIR, unit="°")]
    """Range of their turning against each other."""
    kept: Annotated[Bools, Array("bool", PAIR)]
    """Whether the spanning tree of all parts has this border as a joint."""
    middle: Annotated[Floats, Array("float64", PART, XYZ, unit="length")]
    """Middle of every part on the reference mesh."""
    joint: Annotated[Ints, Array("int32", PART)]
    """Joint of the skeleton that carries each part, −1 for parts that were dropped."""
    length: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Mean over frames of the length of each joint's bone as its parts alone carry it; 0 for the root."""
    deviation: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Standard deviation of it; fixed lengths have none."""

    @property
    def variation(self) -> Floats:
        """(joint,) deviation in % of the mean length; 0 for the root and where a bone has no length."""
        out: Floats = 100.0 * self.deviation / (self.length + (self.length == 0.0))
        return out
