"""One frame's own mesh with its parts."""

import io

import numpy as np
import pytest
import trimesh
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.errors import MeshError
from kinetree.pipeline import views
from kinetree.pipeline.identity.key import file_digest
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.projection import Projection
from kinetree.tasks.results.formats.labels import input_labels
from kinetree.tasks.results.ply import ply

NAMED = plain(spider(), names=tuple("Knie\nü 1" if j == 1 else f"bone_{j}" for j in range(len(spider().names))))


@pytest.fixture
def source(tmp_path):
    body = spider()
    path = tmp_path / "scan.ply"
    trimesh.Trimesh(skinned(body)[4], body.faces, process=False).export(path)
    return Source(content=file_digest(path), path=str(path))


def onto(face, share):
    return Projection(face=face, share=share, distance=np.zeros(len(face)))


def test_file_is_the_frame_as_it_was_given_with_a_part_for_every_vertex(source):
    body = spider()
    n = len(body.vertices)
    corner = {int(v): (f, c) for f, row in enumerate(body.faces) for c, v in enumerate(row)}
    at = np.array([corner[v] for v in range(n)])
    files = views.files(ply(source, onto(at[:, 0], np.eye(3)[at[:, 1]]), body, NAMED), (7,))
    assert list(files) == ["parts/frame_0007.ply"]
    mesh = trimesh.load(io.BytesIO(files["parts/frame_0007.ply"]), file_type="ply", process=False)
    np.testing.assert_allclose(mesh.vertices, skinned(body)[4], atol=1e-5)
    np.testing.assert_array_equal(mesh.faces, body.faces)
    np.testing.assert_array_equal(mesh.metadata["_ply_raw"]["vertex"]["data"]["part"], body.label)
    header = files["parts/frame_0007.ply"].partition(b"end_header")[0].decode("ascii").splitlines()
    comments = [line for line in header if line.startswith("comment part ")]
    parts = sorted(set(body.label.tolist()) - {-1})
    assert comments == [f"comment part {j} " + ("Knie ? 1" if j == 1 else f"bone_{j}") for j in parts]
    assert 1 in parts


def test_frame_that_is_not_the_one_that_was_aligned_is_refused(source):
    with pytest.raises(MeshError, match=r"scan\.ply: the file has \d+ vertices now, but had 2"):
        ply(source, onto([0, 1], np.eye(3)[:2]), spider(), NAMED)


def test_label_is_that_of_the_part_with_the_largest_share_of_the_point():
    body = spider(label=np.arange(len(spider().vertices)) % 2)
    a, b, c = body.label[body.faces[0]]
    flat = next(f for f, row in enumerate(body.label[body.faces]) if len(set(row.tolist())) == 2)
    row = body.label[body.faces[flat]]
    odd = int(np.argmin([np.sum(row == x) for x in row]))
    share = np.full(3, 0.3)
    share[odd] = 0.4
    labels = input_labels(body, onto([0, flat, flat, -1], [[1, 0, 0], share, np.eye(3)[odd], [0, 0, 0]]))
    assert labels.tolist() == [a, row[(odd + 1) % 3], row[odd], -1]
    assert {a, b, c} <= {0, 1}
