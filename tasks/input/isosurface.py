"""The surface of one frame's hull or volume."""

import numpy as np

from kinetree.errors import HullError
from kinetree.pipeline.task import task
from kinetree.schemas.input.hull import Hull
from kinetree.schemas.input.isosurface import Isosurface, IsosurfaceParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.frames.read import name, volume
from kinetree.tasks.numerics.input import isosurface as numerics
from kinetree.tasks.numerics.input.hull import Field


@task(over="frame/volume")
def isosurface(source: Source, hull: tuple[Hull, ...], params: IsosurfaceParams) -> Isosurface:
    """Extracts the surface of the hull, or of a volume that is given, by marching cubes (2009, Sec. 2, step 2)."""
    try:
        if hull:
            field, cut = Field(np.asarray(hull[0].values), np.asarray(hull[0].origin), np.full(3, hull[0].spacing)), 0
        else:
            field, cut = numerics.signed_distance(volume(source), params.level, params.smoothing)
        V, F = numerics.isosurface(field)
    except HullError as error:
        where = name(source)
        raise HullError(str(error) if where in str(error) else f"{where}: {error}") from None
    return Isosurface(vertices=V, faces=F, cut=cut)
