"""What a scene unfolds to counts each part as often as the document names it, and is asked before anything is read."""

import numpy as np
import pytest
from numerics.input.animated_glbs import F, GlbDraft, V
from trimesh.exchange import gltf as trimesh_gltf

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import unpacked
from kinetree.tasks.numerics.input.formats import mesh_of
from kinetree.tasks.numerics.input.gltf import Gltf
from kinetree.tasks.numerics.input.gltf_size import unfolded_bytes


def unfolded(glb):
    return unfolded_bytes(Gltf.of(glb.raw()))


def shown_often(glb, n):
    glb.document["nodes"] *= n
    glb.document["scenes"] = [{"nodes": list(range(n))}]


def of_many_meshes(glb, n):
    glb.document["meshes"] *= n


def of_many_primitives(glb, n):
    glb.document["meshes"][0]["primitives"] *= n


def of_many_views(glb, n):
    glb.document["bufferViews"] *= n


def of_many_accessors(glb, n):
    glb.document["accessors"] *= n


def test_views_accessors_and_primitives_are_counted_as_often_as_they_are_named():
    glb = GlbDraft()
    views, accessors = V.nbytes + F.nbytes, 8 * (V.size + F.size)
    primitive = 8 * (V.size + 3 * F.size) + 1000
    assert unfolded(glb) == views + accessors + 2 * primitive
    shown_often(glb, 5)
    assert unfolded(glb) == views + accessors + 6 * primitive
    glb.document["nodes"][4] = {"children": [0, 0, 1]}
    assert unfolded(glb) == views + accessors + 7 * primitive
    of_many_primitives(glb, 2)
    of_many_accessors(glb, 3)
    assert unfolded(glb) == views + 3 * accessors + 14 * primitive
    glb.document["accessors"].append({"bufferView": 0, "componentType": 5126, "count": 2, "type": "MAT3"})
    assert unfolded(glb) == views + 3 * accessors + 2 * 9 * 8 + 14 * primitive


@pytest.mark.parametrize("name_often", [shown_often, of_many_meshes, of_many_primitives, of_many_views, of_many_accessors])
def test_file_that_names_the_same_bytes_too_often_is_refused_before_memory_is_taken(monkeypatch, name_often):
    glb = GlbDraft()
    glb.primitive["indices"] = glb.add(np.tile(F.reshape(-1), 1000))
    assert len(mesh_of(glb.raw(), "a.glb", ".glb")[1]) == 4000
    name_often(glb, 300)
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 10**6)
    monkeypatch.setattr(trimesh_gltf, "load_glb", pytest.fail)
    raw = glb.raw()
    with pytest.raises(MeshError, match=rf"^a\.glb: its scene: {len(raw)} bytes would unpack to \d+; expected"):
        mesh_of(raw, "a.glb", ".glb")
