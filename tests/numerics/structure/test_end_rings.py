"""Parts with a hinge at rings, and the form in which their places are stored."""

import numpy as np
import pytest
from smeared import Frames, aligned, found_in, turning
from trunk import MIRRORED, trunk

from kinetree.tasks.numerics.structure import end_rings as module
from kinetree.tasks.numerics.structure.end_rings import (
    EndFrames,
    EndRing,
    EndRings,
    Fits,
    closer_rings,
    end_rings,
    laid_in_runs,
    lay_rings,
)
from kinetree.tasks.numerics.structure.first_tree import in_tree_order


def laid(which: list[int], hidden: tuple[int, ...] = ()) -> tuple[list[EndRing], list[Fits]]:
    """The rings of a tube, and how they lie in some frames; the last part is not certain in those that are hidden."""
    body, found = found_in(aligned(turning()))
    tree, confidence = in_tree_order(found, 2), np.ones(body.x.shape[:2])
    confidence[np.ix_(hidden, body.V[:, 2] > 0.0)] = 0.1
    rings = end_rings(body.V, body.F, body.area, tree, np.zeros(len(tree.parents), np.bool_))
    fits: list[Fits] = [{} for _ in rings]
    frame = np.array(which)
    frames = EndFrames.of(tree, body.area, frame, confidence[frame], Frames(turning()).prepared(body.size))
    lay_rings(frames, frame, rings, fits)
    return rings, fits


def test_the_hinge_brings_the_part_nearer_to_the_surface() -> None:
    rings, fits = laid([3, 4])
    assert {ring.cut.part for ring in rings} == {1}
    assert all(sorted(own) == [3, 4] for own in fits)
    assert all(own[f].two < own[f].one for own in fits for f in own)


def test_a_part_that_is_not_certain_is_not_laid() -> None:
    assert all(sorted(own) == [3] for own in laid([3, 4], (4,))[1])


def test_what_is_stored_by_frame_is_read_again_by_ring() -> None:
    (_, whole), parts = laid([3, 4, 5], (4,)), []
    for which in ([3, 4], [5]):
        parts.append(EndRings.of(np.array(which), [{f: own[f] for f in which if f in own} for own in whole]))
    again = EndRings.joined(parts)
    assert again.frame.tolist() == [3, 4, 5]
    assert again.visible[:, 0].tolist() == [True, False, True]
    for own, other in zip(whole, again.fits, strict=True):
        assert list(own) == list(other) == [3, 5]
        for f, fit in own.items():
            assert (fit.one, fit.two) == (other[f].one, other[f].two)
            for mine, stored in zip(fit.pose, other[f].pose, strict=True):
                np.testing.assert_array_equal(mine, stored)


def test_every_run_of_frames_begins_afresh(monkeypatch: pytest.MonkeyPatch) -> None:
    known: list[list[int]] = []
    body, found = found_in(aligned(turning()))
    tree = in_tree_order(found, 2)
    rings = end_rings(body.V, body.F, body.area, tree, np.zeros(len(tree.parents), np.bool_))
    surface = Frames(turning()).prepared(body.size)
    frames = EndFrames.of(tree, body.area, np.arange(24), np.ones(body.x.shape[:2]), surface)
    whole = module._nearest
    monkeypatch.setattr(module, "_nearest", lambda fits, f: known.append(sorted(fits)) or whole(fits, f))
    fits = laid_in_runs(frames, [np.array([3, 4]), np.array([5, 6])], rings[:1])
    assert known == [[], [3], [], [5]]
    assert sorted(fits[0]) == [3, 4, 5, 6]
    assert fits[0][5].two == laid([5, 6])[1][0][5].two


def test_hinges_at_ends_of_limbs_with_a_mirror_image_are_bent_and_no_others(monkeypatch: pytest.MonkeyPatch) -> None:
    body, tree = trunk(turning(0.0))
    mirrored = np.isin(np.arange(4), MIRRORED)
    rings = end_rings(body.V, body.F, body.area, tree, mirrored)
    assert {(bool(ring.cut.hung), ring.cut.part in MIRRORED) for ring in rings if ring.is_mirrored} == {(False, True)}
    assert all(ring.is_mirrored for ring in rings if not ring.cut.hung and ring.cut.part in MIRRORED)
    assert not any(ring.is_mirrored for ring in end_rings(body.V, body.F, body.area, tree, np.zeros(4, np.bool_)))
    asked: list[bool] = []
    whole = module.laid_hinged
    monkeypatch.setattr(module, "laid_hinged", lambda *of, is_bent: asked.append(is_bent) or whole(*of, is_bent=is_bent))
    frames = EndFrames.of(tree, body.area, np.arange(1), np.ones((1, len(body.V))), Frames(turning(0.0)).prepared(body.size))
    lay_rings(frames, np.arange(1), rings, [{} for _ in rings])
    assert asked == [ring.is_mirrored for ring in rings]


def test_closer_rings_lie_half_as_far_apart_in_the_parts_that_are_asked() -> None:
    body, tree = trunk(turning(0.0))
    asked = (body.V, body.F, body.area, tree, np.isin(np.arange(4), MIRRORED))
    first, closer = (
        sorted(ring.cut.centre[2] for ring in rings if ring.cut.hung)
        for rings in (end_rings(*asked), closer_rings(*asked, [0]))
    )
    assert np.diff(closer).mean() < 0.6 * np.diff(first).mean()
    assert closer_rings(*asked, [1, 2, 3]) == []
