"""Contract of the pieces: every node has one, in whatever order frames come, and nothing for fixed connectivity."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.rigid_clusters import rigid_clusters


def test_a_walking_body_has_several_pieces_and_every_node_is_in_one() -> None:
    label = walk().pieces.label
    assert len(label) == len(walk().template.nodes)
    assert 3 <= label.max() + 1 < len(label) / 3
    assert set(label.tolist()) == set(range(int(label.max()) + 1))


def test_order_of_frames_does_not_matter() -> None:
    made = walk()
    mixed = tuple(made.first_refit[t] for t in (3, 0, 4, 1, 2))
    assert np.array_equal(rigid_clusters(made.template, mixed).label, made.pieces.label)


def test_fixed_connectivity_has_none() -> None:
    made = walk()
    empty = deformation_graph(made.reference.model_copy(update={"fixed": True}), DeformationGraphParams())
    assert len(rigid_clusters(empty, ()).label) == 0
