"""Parts on the user's own vertices."""

import numpy as np

from kinetree.schemas.array import Ints
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton


def input_labels(skeleton: Skeleton, projection: Projection) -> Ints:
    """(input_vertex,) the part that holds most of a vertex's point on the reference mesh; −1 where the surface is not
    rigid there, and where cleaning dropped the vertex.
    """
    label = np.full(len(projection.face), -1, np.int32)
    seen = projection.face >= 0
    corners = skeleton.label[skeleton.faces[projection.face[seen]]]
    share = projection.share[seen]
    held = np.stack([np.sum(share * (corners == corners[:, [k]]), axis=1) for k in range(3)], axis=1)
    label[seen] = np.take_along_axis(corners, np.argmax(held, axis=1)[:, None], axis=1)[:, 0]
    return label
