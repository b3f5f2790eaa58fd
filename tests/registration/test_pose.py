"""What is stored comes to the numerics as arrays of their own that may be written to."""

import numpy as np
from stepwise import walk

from kinetree.tasks.registration.pose import graph, pose, target


def test_poses_graphs_and_targets_may_be_written_to_and_leave_the_artifact_alone() -> None:
    made = walk()
    here, body, frame = pose(made.tracking[0]), graph(made.deformation_graph), target(made.mesh[0], made.deformation_graph)
    for array in (here.rotation, here.translation, body.V, body.weight, body.edge, frame.V):
        assert array.flags.writeable
        array[...] = 0
    assert np.abs(made.tracking[0].translation).max() > 0
    assert np.abs(made.deformation_graph.weight).max() > 0
    assert np.abs(made.mesh[0].vertices).max() > 0


def test_target_has_the_size_of_the_reference_and_not_its_own() -> None:
    made = walk()
    assert target(made.mesh[0], made.deformation_graph).size == made.deformation_graph.size
