"""Part labels of the input's own vertices (2014, Sec. 6)."""

import numpy as np

from kinetree.schemas.array import Ints
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton


def input_labels(skeleton: Skeleton, projection: Projection) -> Ints:
    """The part of every input vertex: that with the largest share of its projection onto the reference mesh.

    returns : (input_vertex,) part; −1 where the surface is not rigid, and where cleaning removed the vertex
    """
    label = np.full(len(projection.face), -1, np.int32)
    known = projection.face >= 0
    corners = skeleton.label[skeleton.faces[projection.face[known]]]
    share = projection.share[known]
    share_of_part = np.stack([np.sum(share * (corners == corners[:, [k]]), axis=1) for k in range(3)], axis=1)
    label[known] = np.take_along_axis(corners, np.argmax(share_of_part, axis=1)[:, None], axis=1)[:, 0]
    return label
