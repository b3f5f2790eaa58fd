"""Laws of the undefined area: a pipe of three arms, each with a cone that reaches past the middle of the body."""

import numpy as np
from shapes import y_pipe

from kinetree.tasks.numerics.paper_2014.cones import bands, edges, grown, pieces
from kinetree.tasks.numerics.paper_2014.cylinders import LEAST, cylinders, trimmed

V, F, _ = y_pipe()
WAY = np.stack([[np.cos(a), np.sin(a), 0.0] for a in (0.0, 2 * np.pi / 3, 4 * np.pi / 3)])
DISTANCE = np.linalg.norm(V[None] - 28.0 * WAY[:, None], axis=2)
AREA = np.ones(len(V))
RING = np.stack([grown(bands(d), np.arange(len(V)) == np.argmin(d), AREA, edges(F)) for d in DISTANCE])


def all_rigid(annuli):
    return np.ones(len(annuli), bool)


def test_cones_overlap_at_the_branch_and_what_they_share_is_cut_off():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    assert ((RING >= 0).sum(axis=0) > 1).any()
    cut = trimmed(RING, rigid)
    assert [p.ring.max() for p in cut] == [4, 4, 4], "the rigid area beyond the joint goes, the joint stays"
    assert (sum((p.ring >= 0).astype(int) for p in cut) <= 1).all()


def test_cone_without_a_joint_keeps_what_is_its_own():
    cut = trimmed(RING, np.ones((3, 25), bool))
    for n, piece in enumerate(cut):
        alone = (RING >= 0).sum(axis=0) == 1
        assert ((piece.ring >= 0) == (alone & (RING[n] >= 0))).all()


def test_cone_that_overlaps_with_nothing_is_left_whole():
    (piece,) = trimmed(RING[:1], np.ones((1, 25), bool))
    assert (piece.ring == RING[0]).all()


def test_cylinders_define_all_of_the_surface_and_nothing_twice():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    cones = trimmed(RING, rigid)
    found = cylinders(cones, DISTANCE, AREA, F, all_rigid, 25)
    claimed = sum((p.ring >= 0).astype(int) for p in (*cones, *found))
    assert claimed.max() == 1
    bare = pieces(claimed == 0, edges(F))
    assert np.bincount(bare[bare >= 0]).max(initial=0) < LEAST * len(V)


def test_first_cylinder_is_the_extension_with_the_widest_range():
    rigid = np.ones((3, 25), bool)
    for limb, joint in enumerate((2, 5, 5)):
        rigid[limb, joint] = False
    found = cylinders(trimmed(RING, rigid), DISTANCE, AREA, F, all_rigid, 25)
    assert found[0].limb == 0
    assert [p.cylinder for p in found] == list(range(len(found)))


def test_annuli_of_a_cylinder_are_numbered_from_its_near_end():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    asked = []
    found = cylinders(trimmed(RING, rigid), DISTANCE, AREA, F, lambda a: asked.append(a) or all_rigid(a), 25)
    for piece, annuli in zip(found, asked, strict=True):
        reach = [DISTANCE[piece.limb][mine].mean() for mine in annuli]
        assert reach == sorted(reach)


def test_limb_whose_leaf_is_not_seen_is_not_extended():
    rigid = np.ones((3, 25), bool)
    rigid[:, 4] = False
    unseen = DISTANCE.copy()
    unseen[0] = np.nan
    found = cylinders(trimmed(RING, rigid), unseen, AREA, F, all_rigid, 25)
    assert 0 not in {p.limb for p in found}


def test_body_without_cones_has_no_cylinders():
    assert cylinders([], np.zeros((0, len(V))), AREA, F, all_rigid, 25) == []
