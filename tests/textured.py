"""Textured meshes whose texture coordinates are known: those of a corner follow from its place and the face it is of."""

from io import BytesIO

import numpy as np
from PIL import Image


def png(rgb=(200, 30, 30), size=(4, 4), form="PNG"):
    """The bytes of a picture of one colour."""
    stream = BytesIO()
    Image.new("RGB", size, rgb).save(stream, form)
    return stream.getvalue()


def corner_uv(V, F):
    """(face, corner, 2) from 0 to 1: the plane that the face lies in most, with an island for each of the three axes."""
    place = (V - V.min(axis=0)) / np.ptp(V, axis=0)
    normal = np.abs(np.cross(V[F[:, 1]] - V[F[:, 0]], V[F[:, 2]] - V[F[:, 0]]))
    axis = np.argmax(normal, axis=1)
    others = np.array([[1, 2], [0, 2], [0, 1]])[axis]
    uv = np.take_along_axis(place[F], others[:, None, :].repeat(3, axis=1), axis=2)
    return np.stack([(axis[:, None] + 0.9 * uv[..., 0]) / 3, uv[..., 1]], axis=2)


def obj(V, F, uv, material="skin", library="skin.mtl", copies=True):
    """The text of an OBJ; with `copies`, every second face has vertices of its own at the same places."""
    lines = [f"mtllib {library}", *(f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in V)]
    lines += [f"vt {u:.17g} {v:.17g}" for u, v in uv.reshape(-1, 2)] + [f"usemtl {material}"]
    count = len(V)
    for f, face in enumerate(F):
        own = face + 1
        if copies and f % 2:
            lines += [f"v {x:.17g} {y:.17g} {z:.17g}" for x, y, z in V[face]]
            own = np.arange(count, count + 3) + 1
            count += 3
        lines.append("f " + " ".join(f"{v}/{3 * f + k + 1}" for k, v in enumerate(own)))
    return "\n".join(lines) + "\n"


MTL = "newmtl skin\nKd 0.8 0.8 0.8\nmap_Kd skin.png\n"
