"""Contract of recovery: what was tracked well stays, what was lost comes back from the frame beyond."""

import numpy as np
from stepwise import walk

from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.limb_swing import LimbSwingSettings, with_two_exchanged
from kinetree.tasks.registration.pose import first_pose, graph
from kinetree.tasks.registration.recovery import recovery


def lost(tracked: FirstFit, shift: float, uncovered: float) -> FirstFit:
    moved = np.array(tracked.translation) + shift
    return tracked.model_copy(update={"translation": moved, "uncovered": uncovered})


def test_frame_in_which_tracking_did_not_fail_keeps_its_pose_bit_for_bit() -> None:
    made = walk()
    assert not made.recovery.failed.any()
    assert not len(made.recovery.recovered)
    for t, here in made.first_fit.items():
        pose = first_pose(here, made.recovery, t)
        assert np.array_equal(pose.rotation, here.rotation)
        assert np.array_equal(pose.translation, here.translation)


def test_lost_frame_is_found_again_from_the_frame_beyond_it() -> None:
    made = walk()
    body = graph(made.deformation_graph)
    tracked = {**made.first_fit, 3: lost(made.first_fit[3], 0.5 * made.reference.size, 0.9)}
    found = recovery(made.deformation_graph, made.take_entries, tracked, made.mesh, made.extrema)
    assert found.recovered.tolist() == [3]
    assert found.failed.tolist() == [False, False, False, True, False]
    assert found.uncovered[3] == 0.9
    assert found.uncovered_after[0] < 0.02
    again, true = first_pose(tracked[3], found, 3), first_pose(made.first_fit[3], made.recovery, 3)
    assert np.linalg.norm(shape(body, again)[0] - shape(body, true)[0], axis=1).mean() < 0.01 * made.reference.size


def test_legs_that_were_exchanged_are_put_right_by_an_alike_frame_though_the_frame_is_covered() -> None:
    made = walk()
    body, at = graph(made.deformation_graph), 3
    stems, seen = np.array(made.reference.stems), np.array(made.extrema[at].stems)
    true = first_pose(made.first_fit[at], made.recovery, at)
    every = LimbSwingSettings(stages=((40, np.inf),), ways=1)
    exchanged = with_two_exchanged(body, true, stems, seen, every)[0]
    moved = {"rotation": exchanged.rotation, "translation": exchanged.translation}
    tracked = {**made.first_fit, at: made.first_fit[at].model_copy(update=moved)}
    found = recovery(made.deformation_graph, made.take_entries, tracked, made.mesh, made.extrema)
    assert not found.failed.any()
    assert found.recovered.tolist() == [at]
    again = first_pose(tracked[at], found, at)
    wrong, right = (np.linalg.norm(shape(body, p)[0] - shape(body, true)[0], axis=1).max() for p in (exchanged, again))
    assert right < 0.05 * body.size < wrong


def test_lost_frame_whose_neighbours_are_too_far_is_found_again_from_where_it_shows_limbs() -> None:
    made = walk()
    tracked = {**made.first_fit, 3: lost(made.first_fit[3], 0.5 * made.reference.size, 0.9)}
    away = np.array([0.0, 0.0, 0.4 * made.reference.size])
    far = made.mesh[3].model_copy(update={"vertices": made.mesh[3].vertices + away})
    centre = tuple(np.array(made.extrema[3].centre) + away)
    tips = made.extrema[3].model_copy(update={"stems": made.extrema[3].stems + away, "centre": centre})
    limbless = tips.model_copy(update={"stems": tips.stems[:0]})
    blind, seeing = (
        recovery(made.deformation_graph, made.take_entries, tracked, {**made.mesh, 3: far}, {**made.extrema, 3: limbs})
        for limbs in (limbless, tips)
    )
    assert seeing.uncovered_after[0] < 0.02 < blind.uncovered_after.min(initial=1.0)


def test_lost_frame_beyond_is_no_help_where_no_limbs_are_seen() -> None:
    made = walk()
    tips = {t: at.model_copy(update={"stems": at.stems[:0]}) for t, at in made.extrema.items()}
    gone, worse = (lost(made.first_fit[t], 0.5 * made.reference.size, share) for t, share in ((3, 0.5), (4, 0.9)))
    found = recovery(made.deformation_graph, made.take_entries, {**made.first_fit, 3: gone, 4: worse}, made.mesh, tips)
    assert not len(found.recovered)
    assert found.failed[[3, 4]].all()


def test_usual_share_is_the_smallest_but_for_the_reference() -> None:
    made = walk()
    others = [t.uncovered for frame, t in made.first_fit.items() if frame != made.reference.frame]
    assert made.recovery.usual == min(others)


def test_frame_that_nothing_is_learned_from_keeps_its_first_pose() -> None:
    made = walk()
    assert made.recovery.row(max(made.mesh) + 1) is None
