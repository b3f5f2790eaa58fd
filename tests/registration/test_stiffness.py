"""Contract of stiffness: learned in every pass from all frames, in whatever order; rigid clusters cover all nodes."""

import numpy as np
from stepwise import walk

from kinetree.tasks.registration.stiffness import stiffness


def test_stiffness_is_above_nothing_and_at_most_one_and_some_edges_bend() -> None:
    made = walk()
    assert len(made.stiffness) == made.deformation_graph.passes
    for learned in made.stiffness:
        assert len(learned.stiffness) == len(made.deformation_graph.edges)
        assert ((learned.stiffness > 0) & (learned.stiffness <= 1)).all()
        assert learned.stiffness.min() < 0.5 < learned.stiffness.max()


def test_order_of_frames_does_not_matter() -> None:
    made = walk()
    mixed = tuple(made.refit[0][t] for t in (3, 0, 4, 1, 2))
    again = stiffness(made.deformation_graph, made.first_fit, made.recovery, mixed, made.stiffness[0], (1,))
    assert again == made.stiffness[1]


def test_body_that_never_moves_is_stiff_everywhere() -> None:
    made = walk()
    rest = made.refit[0][made.reference.frame]
    still = stiffness(made.deformation_graph, made.first_fit, made.recovery, (rest, rest), None, (0,))
    assert np.allclose(still.stiffness, 1.0)


def test_a_walking_body_has_several_rigid_clusters_and_every_node_is_in_one() -> None:
    none, sought, remembered = (learned.cluster for learned in walk().stiffness)
    assert (none == -1).all()
    assert 3 <= sought.max() + 1 < len(sought) / 3
    assert set(sought.tolist()) == set(range(int(sought.max()) + 1))
    assert np.array_equal(remembered, sought)
