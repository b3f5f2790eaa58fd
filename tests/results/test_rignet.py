"""The rig as RigNet's text."""

import numpy as np
import pytest
import trimesh
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.pipeline import views
from kinetree.tasks.results.rignet import rignet


@pytest.fixture
def body():
    return spider()


def lines(skeleton):
    rig = views.files(rignet(skeleton, plain(skeleton)), ())["rignet/skeleton.txt"].decode().splitlines()
    return {word: [line.split()[1:] for line in rig if line.split()[0] == word] for word in ("joints", "root", "hier", "skin")}


def test_every_line_is_of_a_known_kind_and_no_joint_is_missing(body):
    rig = lines(body)
    assert sum(map(len, rig.values())) == len(
        views.files(rignet(body, plain(body)), ())["rignet/skeleton.txt"].decode().splitlines()
    )
    assert [row[0] for row in rig["joints"]] == list(body.names)
    np.testing.assert_allclose([[float(x) for x in row[1:]] for row in rig["joints"]], body.rest)


def test_hierarchy_leads_from_the_root_to_every_joint(body):
    rig = lines(body)
    assert rig["root"] == [["trunk"]]
    pairs = [(body.names[p], body.names[j]) for j, p in enumerate(body.parents) if p >= 0]
    assert [tuple(row) for row in rig["hier"]] == pairs


def test_skin_gives_every_vertex_weights_that_sum_to_one(body):
    rows = lines(body)["skin"]
    assert [int(row[0]) for row in rows] == list(range(len(body.vertices)))
    for vertex, row in enumerate(rows):
        weights = dict(zip(row[1::2], map(float, row[2::2]), strict=True))
        assert sum(weights.values()) == pytest.approx(1.0, abs=3e-6)
        assert weights[body.names[body.influence[vertex, 0]]] == pytest.approx(body.weight[vertex, 0], abs=1e-6)


def test_mesh_beside_it_is_the_one_whose_vertices_are_numbered(body, tmp_path):
    path = tmp_path / "skeleton.obj"
    path.write_bytes(views.files(rignet(body, plain(body)), ())["rignet/skeleton.obj"])
    mesh = trimesh.load(path, process=False, maintain_order=True)
    np.testing.assert_allclose(mesh.vertices, body.vertices, rtol=1e-7, atol=1e-7)
    np.testing.assert_array_equal(mesh.faces, body.faces)


def test_names_are_single_words_still_unique():
    rig = lines(spider(names=("a b", "a\nb", "a_b", "é", "<script>", "", "7")))
    assert len({row[0] for row in rig["joints"]}) == 7
    assert all(len(row) == 4 for row in rig["joints"])
