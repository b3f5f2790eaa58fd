"""Contract of the roll: what was lost in many frames is chosen, and nodes know the limb that rolled."""

import numpy as np
from stepwise import lost, walk

from kinetree.tasks.registration.roll import roll


def test_every_frame_has_a_row_and_the_reference_stays() -> None:
    made = walk()
    chosen = made.roll[1]
    assert chosen.frames == tuple(made.mesh)
    assert chosen.candidate.shape == (len(made.mesh), len(made.roll_candidates[1][0].angle))
    assert (chosen.row(made.reference.frame) == -1).all()


def test_a_limb_that_had_lost_its_roll_rolls_and_no_other() -> None:
    made = walk()
    before = tuple(made.refit[0].values())
    found = roll(made.deformation_graph, made.stiffness[1], made.recovery, tuple(lost(1).values()), before, made.roll[0], (1,))
    assert (found.candidate[:, 1] == np.where(np.array(found.frames) == made.reference.frame, -1, 3)).all()
    assert (np.delete(found.candidate, 1, axis=1) == -1).all()
    assert set(found.limb.tolist()) == {-1, 1}
    assert not np.array_equal(found.stiffness, made.roll[1].stiffness)


def test_passes_without_a_search_choose_nothing_and_remember_which_limbs_rolled() -> None:
    made = walk()
    rolled = made.roll[1].model_copy(update={"limb": np.where(made.stiffness[1].cluster == 0, 0, -1).astype(np.int32)})
    before = tuple(made.refit[1].values())
    found = roll(made.deformation_graph, made.stiffness[2], made.recovery, (), before, rolled, (2,))
    assert found.candidate.shape == (len(made.mesh), 0)
    assert np.array_equal(found.limb, rolled.limb)


def test_stiffness_of_the_last_pass_is_looser_between_rigid_clusters() -> None:
    made = walk()
    first, last = made.deformation_graph.edges.T
    between = made.stiffness[2].cluster[first] != made.stiffness[2].cluster[last]
    assert (made.roll[2].stiffness[between] < made.stiffness[2].stiffness[between]).all()
    assert np.array_equal(made.roll[2].stiffness[~between], made.stiffness[2].stiffness[~between])
