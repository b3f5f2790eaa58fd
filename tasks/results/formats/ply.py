"""One mesh with its parts as PLY."""

import io

import numpy as np
import trimesh

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import part_colours


def ply(V: Floats, F: Ints, label: Ints, skeleton: Skeleton) -> bytes:
    """The mesh, in 32-bit floats, with each vertex in its part's colour and with `part`, the joint whose part it is or −1.

    V, F  : (input_vertex, xyz) · (face, corner)
    label : (input_vertex,) as `input_labels` gives it
    """
    mesh = trimesh.Trimesh(V, F, process=False, vertex_colors=part_colours(skeleton.label, skeleton.faces)[label])
    mesh.vertex_attributes["part"] = np.asarray(label, np.int32)
    out = io.BytesIO()
    mesh.export(out, file_type="ply", vertex_normal=False)
    return out.getvalue()
