"""The verdict on a body in order and on spoilt ones, and what it is in words."""

import json

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import bars_of, spider
from results.sample_report import artifacts, confident

from kinetree.pipeline import views
from kinetree.schemas.results.verdict import Finding, Verdict
from kinetree.schemas.structure.error_bars import EvidenceKind
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.tasks.results.surface_error import surface_error
from kinetree.tasks.results.verdict import verdict
from kinetree.tasks.views.verdict import headline, runs, sentence


def of(
    spoilt: dict[int, float] | None = None,
    failed: tuple[int, ...] = (),
    bound: float = 0.1,
    evidence: tuple[EvidenceKind | None, ...] | None = None,
) -> Verdict:
    """The verdict on the spider; in some frames the hand of the input is moved away; every joint is known to a bound.

    evidence : (joint,) how each joint is known; None for motion
    """
    body = spider()
    anatomy = tuple("hand_end_l" if name == "hand" else "shoulder_l" if name == "arm" else "" for name in body.names)
    content = artifacts()
    errors = {}
    for t, (frame, mesh) in enumerate(content["mesh"].items()):
        V = np.array(mesh.vertices)
        hand = np.linalg.norm(V - body.positions[t, body.names.index("hand")], axis=1) < 2.0
        moved = mesh.model_copy(update={"vertices": V + (spoilt or {}).get(frame, 0.0) * np.outer(hand, [0, 0, 1.0])})
        errors[frame] = surface_error(skeleton=body, mesh=moved, index=(frame,))
    return verdict(
        skeleton=body,
        joint_names=plain(body, anatomy=anatomy),
        frame_confidence=confident(body.frames, failed=failed),
        surface_error=errors,
        error_bars=bars_of(body).model_copy(
            update={
                "bound": np.where(np.array(body.kinds) == "joint", bound, np.nan),
                "evidence": evidence or bars_of(body).evidence,
            }
        ),
    )


def test_a_body_in_order_is_good() -> None:
    found = of()
    assert (found.level, [f.kind for f in found.findings]) == ("good", ["unpaired"])
    (line,) = views.remarks(found)
    assert line.startswith("good: the skinned mesh follows the input in all 12 frames, every part to ")


def test_one_spoilt_frame_is_found_with_its_part_and_named() -> None:
    found = of({7: 6.0})
    assert found.level == "except"
    assert [(f.kind, f.frames) for f in found.findings if f.severity == "fault"] == [("off", (7,))]
    assert "arm" in found.findings[0].joints
    headline, reason = views.remarks(found)
    assert headline.startswith("good except for ")
    assert "left shoulder" in headline
    assert headline.endswith("in frame 7")
    assert "wrong in frame 7" in reason


def test_headline_counts_frames_that_lie_apart_and_the_reason_names_them() -> None:
    headline, *reasons = views.remarks(of(failed=(1, 4, 9)))
    assert headline == "good except for 3 of 12 frames"
    assert reasons[0].startswith("alignment failed in frames 1, 4, 9: ")
    assert views.remarks(of(failed=(1, 3)))[0] == "good except for frames 1, 3"


def test_a_failed_alignment_is_found() -> None:
    assert views.remarks(of(failed=(3, 4))) == (
        "good except for frames 3–4",
        "alignment failed in frames 3–4: the body does not fit the input there",
    )


def test_a_body_that_is_wrong_in_many_frames_is_not_to_be_used() -> None:
    found = of(dict.fromkeys(range(6), 6.0))
    assert found.level == "unusable"
    assert views.remarks(found)[0] == "do not use: wrong in 50% of the frames"


def test_joints_with_a_large_bound_are_named_with_it_as_share_of_the_longest_side() -> None:
    side = float(np.ptp(spider().vertices, axis=0).max())
    line, reason = views.remarks(of(bound=0.08 * side))
    assert line.startswith("good except for left shoulder (within 8 %)")
    meaning = "may be off; nine of ten such joints lie nearer their true place than that share of the body's longest side"
    assert reason == f"left shoulder (within 8 %), knee (within 8 %): {meaning}"
    (found,) = [f for f in views.summary(of(bound=0.08 * side))["findings"] if f["kind"] == "imprecise"]
    assert found["bounds"] == pytest.approx([0.08] * len(found["joints"]))


def test_run_json_has_the_verdict_with_joints_as_people_call_them() -> None:
    told = json.loads(json.dumps(views.summary(of({7: 6.0}))))
    assert told["level"] == "except"
    assert told["headline"].startswith("good except for ")
    worst = told["findings"][0]
    assert (worst["kind"], worst["frames"], worst["labels"]) == ("off", [7], ["left shoulder"])
    assert worst["sentence"].startswith("left shoulder: wrong in frame 7")


def test_text_of_the_verdict_marks_faults_and_notes() -> None:
    first, *rest = views.text(of({7: 6.0}))
    assert first.startswith("good except for ")
    assert [line[:4] for line in rest] == ["  ! ", "  · "]


def test_skeleton_is_shown_with_the_verdict_and_names_that_people_know() -> None:
    found, body = of({7: 6.0}), spider()
    names = plain(body, anatomy=("pelvis", "shoulder_l", *[""] * 5))
    lines = views.text(body, {JointNames: names, Verdict: found}.get)
    assert lines[0].startswith("good except for ")
    assert lines[2].startswith("pelvis (trunk)")
    assert any("left shoulder (arm)  " in line for line in lines)
    assert any("─ tail  " in line for line in lines)
    assert views.text(body)[0].startswith("trunk  ")


def test_headline_counts_joints_where_there_are_many() -> None:
    many = Finding(kind="uncertain", severity="fault", frames=(7,), joints=spider().names[:4])
    found = of().model_copy(update={"level": "except", "findings": (many,)})
    assert headline(found) == "good except for 4 joints in frame 7"
    assert sentence(many, found).startswith("trunk, left shoulder, ")


def test_frames_are_told_as_runs() -> None:
    assert runs((3,), range(9)) == "frame 3"
    assert runs((0, 1, 2, 5), range(9)) == "frames 0–2, 5"
    assert runs((0, 10, 20), (0, 10, 20, 30)) == "frames 0–20"
    assert runs(range(0, 40, 2), range(40)).endswith("and 14 more intervals")


@pytest.mark.parametrize("kind", Finding.model_fields["kind"].annotation.__args__)  # type: ignore[union-attr]
def test_every_kind_of_finding_has_its_sentence(kind: str) -> None:
    found = Finding(kind=kind, severity="fault", frames=(1, 2), joints=("arm", "knee"), amount=0.05)  # type: ignore[arg-type]
    text = sentence(found, of())
    assert text[0].islower()
    assert not text.endswith(".")


def test_a_joint_that_the_shape_alone_shows_is_named_with_the_words_for_it() -> None:
    alone = tuple(
        "shape" if name == "knee" else known for name, known in zip(spider().names, bars_of(spider()).evidence, strict=True)
    )
    line, reason, *_ = views.remarks(of(evidence=alone))
    assert line == "good except for knee"
    assert reason == "knee: placed by the body's shape alone, no turn was measured there"
