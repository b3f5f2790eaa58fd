"""Contract of one cleaned frame: the body and the way back to the user's own vertices, on shapes whose answer is known."""

import numpy as np
import pytest

from kinetree.errors import MeshError, SourceError
from kinetree.pipeline.identity.key import file_digest
from kinetree.schemas.input.mesh import MeshParams
from kinetree.schemas.input.source import Source
from kinetree.tasks.input.mesh import mesh

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


@pytest.fixture
def frame(tmp_path):
    def write(vertices=V, faces=F):
        path = tmp_path / "frame.off"
        rows = [" ".join(map(str, v)) for v in vertices] + ["3 " + " ".join(map(str, f)) for f in faces]
        path.write_text(f"OFF\n{len(vertices)} {len(faces)} 0\n" + "\n".join(rows) + "\n")
        return Source(content=file_digest(path), path=str(path))

    return write


def test_clean_tetrahedron_stays_as_it_is(frame):
    cleaned = mesh(frame(), MeshParams())
    np.testing.assert_array_equal(cleaned.vertices, V)
    np.testing.assert_array_equal(cleaned.vertex_of_input, range(4))
    cleaning = cleaned.cleaning
    assert (cleaning.merged, cleaning.flipped, cleaning.components, cleaning.boundary_edges, cleaning.euler) == (0, 0, 1, 0, 2)
    assert cleaning.volume == pytest.approx(1 / 6)
    assert cleaning.area == pytest.approx(1.5 + np.sqrt(3) / 2)


def test_every_corner_is_found_again_among_the_users_vertices(frame):
    soup = V[F].reshape(-1, 3)  # three vertices a face, as STL has them
    cleaned = mesh(frame(soup, np.arange(12).reshape(4, 3)), MeshParams())
    assert len(cleaned.vertices) == 4
    assert cleaned.cleaning.merged == 8
    np.testing.assert_array_equal(cleaned.vertices[cleaned.vertex_of_input], soup)


def test_inside_out_is_turned_and_told(frame):
    cleaned = mesh(frame(faces=F[:, ::-1]), MeshParams())
    assert cleaned.cleaning.flipped == 4
    assert cleaned.cleaning.volume == pytest.approx(1 / 6)


def test_open_surface_has_a_boundary_and_no_volume(frame):
    cleaned = mesh(frame(faces=F[:3]), MeshParams())
    assert cleaned.cleaning.boundary_edges == 3
    assert cleaned.cleaning.volume is None
    assert cleaned.cleaning.euler == 1


def test_debris_is_dropped_by_its_share_and_the_way_back_says_so(frame):
    both, faces = np.concatenate([V, 5 + V / 10]), np.concatenate([F, F + 4])
    cleaned = mesh(frame(both, faces), MeshParams())
    assert (cleaned.cleaning.components, cleaned.cleaning.components_kept) == (2, 1)
    np.testing.assert_array_equal(cleaned.vertex_of_input, [0, 1, 2, 3, -1, -1, -1, -1])
    assert cleaned.cleaning.share_kept == pytest.approx(1 / 1.01)
    whole = mesh(frame(both, faces), MeshParams(component_share=0))
    assert whole.cleaning.components_kept == 2


def test_unusable_frame_is_refused_by_its_name(frame):
    with pytest.raises(MeshError, match=r"frame\.off: its bounding box has a diagonal of 0"):
        mesh(frame(vertices=V * 0), MeshParams())
    with pytest.raises(MeshError, match=r"frame\.off: vertex 2 of face 0 is 7, but the mesh has 4 vertices"):
        mesh(frame(faces=[[0, 1, 7]]), MeshParams())


def test_frame_that_changed_since_planning_is_refused(frame):
    planned = frame()
    frame(vertices=V * 2)
    with pytest.raises(SourceError, match=r"^frame\.off: the file changed while the run was under way; run again$"):
        mesh(planned, MeshParams())


@pytest.mark.parametrize(
    "wrong", [{"merge": -1}, {"merge": 0.1}, {"component_share": 1.5}, {"component_share": -0.1}, {"mergee": 0}]
)
def test_parameters_out_of_range_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        MeshParams(**wrong)
