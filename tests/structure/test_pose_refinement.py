"""The fit as a task: frames in doubt alone, all joints of them, ends of bones too."""

import numpy as np
import pytest
from articulated import Known
from fitting import FIRST, SPOILT, arms, articulation, surface_at

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.kinematic_tree import MOST_TOGETHER
from kinetree.schemas.structure.pose_refinement import PoseRefinement
from kinetree.tasks.structure.pose_refinement import pose_refinement


def refined(known: Known, rows: tuple[int, ...]) -> PoseRefinement:
    _, body = arms()
    surfaces = {row: surface_at(known, body, row) for row in rows}
    mesh = {
        FIRST + row: Mesh(vertices=s.V, faces=s.F, vertex_of_input=np.arange(len(s.V)), cleaning=Cleaning())
        for row, s in surfaces.items()
    }
    zero, one = np.zeros(len(known.V)), np.ones(len(known.V))
    trust = np.where(known.label == 1, 0.1, 1.0)
    aligned = {
        FIRST + row: Alignment(vertices=known.x[row], residual=zero, stretch=one, confidence=trust, uncovered=0.0)
        for row in rows
    }
    return pose_refinement(articulation(known), mesh, aligned)


def test_arm_that_was_off_is_where_its_surface_is() -> None:
    known, body = arms()
    found = refined(known, SPOILT)
    before = articulation(known).positions[list(SPOILT)]
    true = articulation(known, ()).positions[list(SPOILT)]
    assert found.frames == (FIRST + 6, FIRST + 7)
    assert found.moved.all()
    assert np.linalg.norm(found.positions - true, axis=2).max() < 0.01 * body.size < np.linalg.norm(before - true, axis=2).max()
    assert found.confidence[:, 1:3].min() > 0.5
    assert (found.after < found.before).all()


def test_ends_of_bones_go_with_their_bones() -> None:
    known, _ = arms()
    found = refined(known, SPOILT)
    assert found.rotation[:, 2] == pytest.approx(found.rotation[:, 1])
    reach = np.linalg.norm(found.positions[:, 2] - found.positions[:, 1], axis=1)
    assert reach == pytest.approx(np.full(2, np.linalg.norm(known.joints[1])))


def test_frame_that_is_right_keeps_its_bytes() -> None:
    known, _ = arms()
    found, before = refined(known, (3,)), articulation(known)
    assert not found.moved.any()
    for name in ("positions", "rotation", "confidence"):
        assert getattr(found, name)[0].tobytes() == getattr(before, name)[3].tobytes()


def test_same_input_gives_the_same_bytes() -> None:
    known, _ = arms()
    one, two = refined(known, SPOILT), refined(known, SPOILT)
    for name in PoseRefinement.array_fields():
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()


def test_frames_in_doubt_go_in_runs_and_a_few_at_a_time() -> None:
    known, _ = arms()
    long = tuple(range(1, 2 + MOST_TOGETHER))
    of = articulation(known, (*long, 12, 14))
    assert of.members("doubt", ()) == range(4)
    runs = [tuple(f - FIRST for f in of.members("doubt/frame", (k,))) for k in range(4)]
    assert runs == [long[:MOST_TOGETHER], long[MOST_TOGETHER:], (12,), (14,)]
    assert list(articulation(known, ()).members("doubt", ())) == []
