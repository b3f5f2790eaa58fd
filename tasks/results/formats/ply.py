"""One input mesh with its parts as PLY (ours)."""

import io

import numpy as np
import trimesh

from kinetree.schemas.array import Floats, Ints
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import part_colours


def ply(V: Floats, F: Ints, label: Ints, skeleton: Skeleton) -> bytes:
    """The mesh in 32-bit floats; every vertex has its part's colour and the property `part`, a joint or −1.

    A comment in the header, such as `comment part 7 knee_l`, has the name of each part that some vertex of the body has.

    V     : (input_vertex, xyz) input's unit
    F     : (face, corner)
    label : (input_vertex,) part as `input_labels` gives it
    """
    mesh = trimesh.Trimesh(V, F, process=False, vertex_colors=part_colours(skeleton.label, skeleton.faces)[label])
    mesh.vertex_attributes["part"] = np.asarray(label, np.int32)
    file = io.BytesIO()
    mesh.export(file, file_type="ply", vertex_normal=False)
    header, element, rest = file.getvalue().partition(b"element")
    known = np.unique(skeleton.label[skeleton.label >= 0]).tolist()
    parts = [f"comment part {j} {' '.join(skeleton.names[j].split())}\n" for j in known]
    return header + "".join(parts).encode("ascii", "replace") + element + rest
