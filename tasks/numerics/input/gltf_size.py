"""To how much the scene of a GLB unfolds where it is read as one mesh, told from its document alone."""

from collections.abc import Mapping
from typing import Any

from kinetree.tasks.numerics.input.gltf import Gltf, whole

_STRIP = 3
"""Corners of faces for each index of a strip; of triangles it is one."""
_PLACE_BYTES = 1000
"""That trimesh keeps of a primitive each time a node shows it."""


def unfolded_bytes(gltf: Gltf) -> int:
    """Bytes of all views and accessors, and of primitives as often as meshes name them and nodes show them.

    raises : SourceError where an accessor is too large for any body, or the document names what is not there
    """
    views = sum(whole(view.get("byteLength", 0)) for view in gltf.items("bufferViews"))
    accessors = sum(gltf.size(k) for k in range(len(gltf.items("accessors"))))
    meshes = [sum(_size(gltf, p) for p in mesh.get("primitives", ())) for mesh in gltf.items("meshes")]
    nodes = gltf.items("nodes")
    scene = gltf.item("scenes", gltf.document.get("scene", 0)) if gltf.items("scenes") else {}
    shown = [*set(scene.get("nodes", ())), *(child for node in nodes for child in set(node.get("children", ())))]
    return views + accessors + sum(meshes) + sum(meshes[nodes[i]["mesh"]] for i in shown if "mesh" in nodes[i])


def _size(gltf: Gltf, primitive: Mapping[str, Any]) -> int:
    """Bytes of the vertices and faces of a primitive as numbers."""
    position, indices = primitive.get("attributes", {}).get("POSITION"), primitive.get("indices")
    vertices = 0 if position is None else gltf.size(position)
    return vertices + (vertices if indices is None else _STRIP * gltf.size(indices)) + _PLACE_BYTES
