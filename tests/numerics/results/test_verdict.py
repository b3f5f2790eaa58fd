"""Laws of the verdict: what is in order is good, every fault is found where it is, and nothing else is blamed."""

from typing import Any

import numpy as np
import pytest

from kinetree.tasks.numerics.results.verdict import TRUSTED, UNCERTAIN, WRONG, Evidence, VerdictSettings, sided, verdict

FRAMES, JOINTS = 12, 5
UNKNOWN = np.full(JOINTS, np.nan)


def evidence(**changes: Any) -> Evidence:
    """A root, three joints and an end, all in order."""
    none = np.full((FRAMES, JOINTS), 0.002)
    return Evidence(**{
        "skin": none, "surface": none, "outside": 0 * none, "distance": none[:, 0], "inlier": np.ones(FRAMES, bool),
        "confidence": np.full((FRAMES, JOINTS), 0.9), "support": np.full(JOINTS, FRAMES), "degrees": np.full(JOINTS, 40.0),
        "turning": np.array([False, True, True, True, False]), "length": np.full(JOINTS, 0.2), "pairs": [(1, 2)],
        "expected": np.array([np.nan, 0.006, 0.006, 0.006, np.nan]), "bound": np.array([np.nan, 0.02, 0.02, 0.02, np.nan]),
        "by_shape": np.zeros(JOINTS, bool), "by_narrowing": np.zeros(JOINTS, bool),
        "by_mirror": np.zeros(JOINTS, bool), "unpaired": [], **changes,
    })  # fmt: skip


def changed(name: str, at: Any, value: float) -> Evidence:
    values = np.array(getattr(evidence(), name))
    values[at] = value
    return evidence(**{name: values})


def kinds(of: Evidence) -> list[str]:
    return [found.kind for found in verdict(of).findings]


def test_what_is_in_order_is_good_and_nothing_is_found() -> None:
    found = verdict(evidence())
    assert (found.level, found.findings) == ("good", ())
    assert (found.state == TRUSTED).all()


@pytest.mark.parametrize("way", ["skin", "surface"])
def test_one_spoilt_frame_is_found_with_its_part(way: str) -> None:
    found = verdict(changed(way, (7, 2), 0.14))
    assert found.level == "except"
    assert [(f.kind, f.frames, f.joints, f.amount) for f in found.findings] == [("off", (7,), (2,), 0.14)]
    assert found.state[7, 2] == WRONG
    assert (np.delete(found.state.ravel(), 7 * JOINTS + 2) == TRUSTED).all()


def test_frames_in_which_the_same_parts_are_wrong_are_one_finding() -> None:
    of = changed("skin", (slice(2, 4), 2), 0.1)
    of.skin[9, [2, 3]] = 0.2
    assert [(f.frames, f.joints) for f in verdict(of).findings] == [((9,), (2, 3)), ((2, 3), (2,))]


def test_a_frame_that_the_alignment_does_not_explain_is_found() -> None:
    found = verdict(evidence(inlier=np.arange(FRAMES) != 4))
    assert [(f.kind, f.frames, f.joints) for f in found.findings] == [("off", (4,), ())]


def test_a_hidden_joint_is_uncertain_where_it_is_hidden() -> None:
    found = verdict(changed("confidence", (slice(3, 6), 1), 0.2))
    assert [(f.kind, f.frames, f.joints) for f in found.findings] == [("uncertain", (3, 4, 5), (1,))]
    assert (found.state[3:6, 1] == UNCERTAIN).all()


def test_joints_that_are_uncertain_in_the_same_frames_are_one_finding() -> None:
    of = changed("confidence", (slice(3, 6), slice(1, 3)), 0.2)
    of.confidence[2:6, 3] = 0.1
    assert [(f.frames, f.joints) for f in verdict(of).findings] == [((2, 3, 4, 5), (3,)), ((3, 4, 5), (1, 2))]


def test_roots_and_ends_have_no_confidence_and_no_place_of_their_own() -> None:
    assert verdict(changed("confidence", (3, 4), 0.1)).level == "good"
    assert verdict(changed("outside", (3, 4), 0.1)).level == "good"


def test_a_joint_outside_the_body_is_found_and_not_twice() -> None:
    assert kinds(changed("outside", (3, 2), 0.02)) == ["outside"]
    both = changed("outside", (3, 2), 0.2)
    both.skin[3, 2] = 0.1
    assert kinds(both) == ["off"]


def test_a_weak_joint_is_found_by_support_and_by_confidence() -> None:
    assert kinds(changed("support", 2, 3)) == ["weak"]
    assert kinds(changed("confidence", (slice(None), 3), 0.3)) == ["weak"]


def test_joints_whose_error_bar_is_large_are_named_with_their_bounds_the_worst_first() -> None:
    bound = np.array([np.nan, 0.06, 0.02, 0.09, 0.5])
    found = verdict(evidence(bound=bound))
    assert found.level == "except"
    assert [(f.kind, f.joints, f.amount, f.bounds) for f in found.findings] == [("imprecise", (3, 1), 0.09, (0.09, 0.06))]
    assert kinds(changed("expected", 2, 0.03)) == ["imprecise"]
    assert kinds(changed("expected", 4, 0.03)) == [], "ends of bones have no error bars"
    assert verdict(evidence(expected=UNKNOWN, bound=UNKNOWN)).level == "good"


def test_bones_of_unlike_length_on_both_sides_are_found() -> None:
    found = verdict(changed("length", 2, 0.26)).findings
    assert [(f.kind, f.joints) for f in found] == [("asymmetric", (1, 2))]
    assert found[0].amount == pytest.approx(0.06)
    assert kinds(changed("length", 3, 0.5)) == []


def test_bones_of_unlike_length_are_a_note_where_one_of_the_joints_is_doubtful_anyway() -> None:
    both = changed("length", 2, 0.26)
    degrees = np.array(both.degrees)
    degrees[2] = 9.0
    found = verdict(both._replace(degrees=degrees)).findings
    assert [(f.kind, f.severity) for f in found] == [("small", "fault"), ("asymmetric", "note")]


def test_notes_leave_a_result_good() -> None:
    assert kinds(evidence(unpaired=[3])) == ["unpaired"]
    assert verdict(evidence(unpaired=[3])).level == "good"


def test_a_joint_that_hardly_turns_or_is_very_near_another_is_doubtful() -> None:
    for name, value, kind in (("degrees", 9.0, "small"), ("length", 0.02, "close")):
        found = verdict(changed(name, 3, value))
        assert (found.level, [(f.kind, f.joints, f.amount) for f in found.findings]) == ("except", [(kind, (3,), value)])
    both = evidence(degrees=np.array([0, 9, 40, 40, 0.0]), length=np.array([0, 0.02, 0.02, 0.2, 0.2]), pairs=[])
    assert [(f.kind, f.joints) for f in verdict(both).findings] == [("small", (1,)), ("close", (2,))]


def test_a_body_that_hardly_moves_is_no_good_and_one_that_never_turns_is_unusable() -> None:
    assert kinds(evidence(degrees=np.full(JOINTS, 9.0))) == ["still"]
    assert verdict(evidence(turning=np.zeros(JOINTS, bool))).level == "unusable"


def test_a_short_sequence_is_found() -> None:
    cut = {
        name: np.asarray(getattr(evidence(), name))[:3]
        for name in ("skin", "surface", "outside", "distance", "inlier", "confidence")
    }
    assert kinds(evidence(**cut, support=np.full(JOINTS, 3))) == ["short"]


def test_a_result_that_explains_nothing_or_fails_too_often_is_unusable() -> None:
    far = verdict(evidence(distance=np.full(FRAMES, 0.02)))
    assert (far.level, far.findings[0].kind) == ("unusable", "unexplained")
    often = verdict(changed("skin", (slice(0, 5), 1), 0.1))
    assert (often.level, often.findings[0].kind) == ("unusable", "lost")
    assert often.findings[1].kind == "off", "the most serious first"


def test_limits_are_those_of_the_settings() -> None:
    assert verdict(changed("skin", (7, 2), 0.14), VerdictSettings(uncertain=0.2, wrong=0.2)).level == "good"


def test_sides_are_paired_where_their_parents_are() -> None:
    anatomy = ("pelvis", "hip_l", "hip_r", "knee_l", "knee_r", "ankle_r", "toe_l", "toe_r", "")
    parents = (-1, 0, 0, 1, 2, 4, 3, 5, 0)
    pairs, unpaired = sided(anatomy, parents)
    assert pairs == [(1, 2), (3, 4)], "toes hang on unlike joints"
    assert unpaired == [5]


def test_a_joint_that_the_shape_alone_shows_is_named_for_that_and_not_for_turning_little() -> None:
    neck = np.arange(JOINTS) == 3
    found = verdict(evidence(by_shape=neck, degrees=np.where(neck, 0.0, 40.0)))
    assert (found.level, [(f.kind, f.joints) for f in found.findings]) == ("except", [("shape", (3,))])
    still = evidence(by_shape=neck, degrees=np.where(neck, 0.0, 9.0))
    assert kinds(still) == ["still", "shape"]


@pytest.mark.parametrize("kind", ["narrowing", "mirror"])
def test_a_joint_that_the_other_side_or_a_narrowing_alone_shows_is_good_to_know_and_no_fault(kind: str) -> None:
    toe = np.arange(JOINTS) == 3
    known = {f"by_{kind}": toe}
    found = verdict(evidence(**known, degrees=np.where(toe, 0.0, 40.0)))
    assert (found.level, [(f.kind, f.severity, f.joints) for f in found.findings]) == ("good", [(kind, "note", (3,))])
    assert kinds(evidence(**known, degrees=np.where(toe, 0.0, 9.0))) == ["still", kind]
