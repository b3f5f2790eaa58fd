"""Visual hull of one frame: what silhouettes say about the body, on a grid."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Artifact, Floats, Params
from kinetree.schemas.dims import GRID_X, GRID_Y, GRID_Z, XYZ


class HullParams(Params):
    """How finely silhouettes are carved, and which views a frame needs."""

    resolution: int = Field(default=128, ge=16, le=512)
    """Voxels on the longest side of the body."""
    smoothing: float = Field(default=1.0, ge=0, le=10)
    """Pixels over which the outline of a mask is smoothed; 0 keeps the steps of its raster."""
    least_views: int | None = Field(default=None, ge=2)
    """Views with a mask that a frame needs; None needs all. Fewer views carve a larger hull."""


class Hull(Artifact):
    """Signed distance of the visual hull, positive inside, cut off a few voxels from the surface."""

    values: Annotated[Floats, Array("float32", GRID_X, GRID_Y, GRID_Z, unit="length")]
    """Distance to the surface at every grid point."""
    origin: Annotated[Floats, Array("float64", XYZ, unit="length")]
    """Place of the first grid point."""
    spacing: float
    """Between neighbours on the grid, length."""
    views: int
    """Views that were carved with."""
    missing: tuple[str, ...] = ()
    """Cameras without a mask in this frame, or with an empty one."""
    cut: tuple[str, ...] = ()
    """Cameras whose image cuts the body at its border; nothing beyond the border was carved by them."""
