"""Visual hull of one frame's silhouettes."""

import numpy as np

from kinetree.errors import HullError
from kinetree.pipeline.task import task
from kinetree.schemas.input.hull import Hull, HullParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.frames.read import name, silhouettes
from kinetree.tasks.numerics.input import hull as numerics
from kinetree.tasks.numerics.input.mask_distance import cut_sides


@task(over="frame/silhouettes")
def hull(source: Source, params: HullParams) -> Hull:
    """Carves the visual hull of one frame from its silhouettes, as a signed distance (2009, Sec. 2, step 1)."""
    calibration, masks = silhouettes(source)
    carving = [c for c, mask in enumerate(masks) if mask is not None and mask.any()]
    missing = [calibration.names[c] for c in range(len(masks)) if c not in carving]
    needed = len(masks) if params.least_views is None else params.least_views
    if len(carving) < max(needed, 2):
        remedy = f"; to carve with the others set hull.least_views={len(carving)}" if len(carving) > 1 else ""
        raise HullError(
            f"{name(source)}: no mask, or an empty one, of camera {', '.join(missing) or 'two'}: {len(carving)} of"
            f" {len(masks)} views, {max(needed, 2)} are needed{remedy}"
        )
    used = [np.asarray(masks[c], dtype=np.bool_) for c in carving]
    names = [calibration.names[c] for c in carving]
    try:
        field = numerics.hull(used, calibration.P[carving], params.resolution, params.smoothing, names)
    except HullError as error:
        raise HullError(f"{name(source)}: {error}") from None
    cut = tuple(camera for camera, mask in zip(names, used, strict=True) if any(cut_sides(mask)))
    return Hull(
        values=field.values,
        origin=field.origin,
        spacing=float(field.spacing[0]),
        views=len(carving),
        missing=tuple(missing),
        cut=cut,
    )
