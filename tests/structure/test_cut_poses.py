"""The poses of further cuts as the task gives them."""

from aligned_body import FIRST, task_inputs
from articulated import three_arms

from kinetree.schemas.structure.cut_poses import CutPoses
from kinetree.schemas.structure.rigid_parts import CutParams, RigidPartsParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.structure.cut_poses import cut_poses


def poses(**params: int) -> CutPoses:
    body = three_arms()
    reference, aligned, _ = task_inputs(body.V, body.F, body.x)
    return cut_poses(reference, aligned, RigidPartsParams(**params))


def test_further_cuts_are_in_other_poses_than_the_reference_and_one_cut_has_none() -> None:
    found, alone = poses(cuts=3), poses(cuts=1)
    assert len(set(found.frames) - {FIRST + 2}) == 2
    assert found.members("cut", ()) == sorted(found.frames)
    assert alone.frames == ()


def test_they_are_cut_as_the_first_one() -> None:
    assert poses(cuts=2, rings=20).settings == CutParams(rings=20)
    assert METHODS["mesoscopic"].by_name["cut_poses"].block == "rigid_parts"


def test_no_further_cut_waits_for_the_first() -> None:
    graph = METHODS["mesoscopic"]
    assert graph.by_name["rigid_parts"] not in graph.reads(graph.by_name["further_cut"])
