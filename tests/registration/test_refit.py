"""Contract of the refits: closer to the frames, the reference stays at rest, and no frame needs another."""

import numpy as np
from stepwise import aligned, generated, lost, refitted, walk

from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.registration.pose import graph, pose, rolled_pose
from kinetree.tasks.registration.roll import roll


def test_reference_stays_at_rest_through_all_passes() -> None:
    made = walk()
    assert len(made.refit) == 3
    rest = made.deformation_graph.vertices[made.deformation_graph.nodes]
    for refit in made.refit:
        assert np.array_equal(refit[made.reference.frame].translation, rest)


def test_refitted_body_lies_closer_to_the_frames_than_the_tracked_one() -> None:
    made = walk()
    body = graph(made.deformation_graph)

    def residual(poses):
        x = {t: shape(body, pose(p))[0] for t, p in poses.items()}
        return np.mean([residuals(x[t], np.array(m.vertices), m.faces).mean() for t, m in made.mesh.items()])

    assert residual(made.refit[-1]) < residual(made.first_fit)


def test_frame_is_fitted_by_itself() -> None:
    made = walk()
    assert refitted(made, 0, 4, None) == made.refit[0][4]
    assert refitted(made, 2, 4, made.refit[1][4]) == made.refit[2][4]


def test_fixed_connectivity_has_no_passes() -> None:
    made = aligned(generated(connectivity="fixed", frames=3))
    assert list(made.deformation_graph.members("pass", ())) == []
    assert made.refit == made.roll == made.stiffness == []


def test_only_the_limb_that_rolled_moves_and_the_reference_stays() -> None:
    made = walk()
    body, told, before = graph(made.deformation_graph), lost(1), tuple(made.refit[0].values())
    chosen = roll(made.deformation_graph, made.stiffness[1], made.recovery, tuple(told.values()), before, made.roll[0], (1,))
    for t, before in made.refit[0].items():
        start = rolled_pose(body, before, told[t], made.stiffness[1], chosen.row(t))
        moved = (start.rotation != before.rotation).any(axis=(1, 2))
        assert np.array_equal(moved, (chosen.limb == 1) & (t != made.reference.frame))
