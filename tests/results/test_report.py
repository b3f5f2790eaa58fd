"""The report of a small body: its facts, its warnings, its chapters, and text from outside that must not become markup."""

import re
from html import unescape
from typing import Any

import numpy as np
import pytest
import trimesh
from results.plain_names import plain
from results.rigged_bodies import bars_of, spider
from results.sample_report import artifacts, confident, judged, page_artifacts

from kinetree.schemas.input.mesh import Cleaning
from kinetree.schemas.results.assumed_joints import AssumedJoint, AssumedJoints
from kinetree.schemas.results.excerpt import ExcerptParams
from kinetree.schemas.results.report import RUN, ReportParams
from kinetree.tasks.results.report import report
from kinetree.tasks.structure.error_bars import unknown_error_bars


def page(title: str = "", **changes: Any) -> str:
    arguments = page_artifacts(ExcerptParams(frames=4, views=1), **changes)
    return report(**arguments, params=ReportParams(title=title)).text.tobytes().decode()


def listed(text: str, box: str) -> list[str]:
    """The sentences in a box: verdict or notes."""
    found = re.search(rf'class="{box}.*?</(section|details)>', text, re.DOTALL)
    return [unescape(re.sub("<.*?>", "", item)) for item in re.findall("<li>(.*?)</li>", found.group())] if found else []


def facts(text: str) -> dict[str, str]:
    items = re.search(r'<ul class="facts">(.*?)</ul>', text, re.DOTALL)
    assert items is not None
    return {name: unescape(value) for name, value in re.findall("<li>(.*?) <b>(.*?)</b></li>", items.group(1))}


def headings(text: str) -> list[str]:
    return re.findall(r'<section id="(\w+)">', text)


@pytest.fixture(scope="module")
def plain_page() -> str:
    return page()


def test_facts_are_at_the_head_of_the_page(plain_page: str) -> None:
    content = facts(plain_page)
    assert (content["frames"], content["joints"], content["intervals"]) == ("12", "2", "2")
    assert (content["unit"], content["frames a second"]) == ("mm", "10")


def test_every_joint_is_in_the_table(plain_page: str) -> None:
    rows = re.findall("<tr[^>]*>(.*?)</tr>", plain_page)
    for name in spider().names:
        assert any(f"<td>{name}</td>" in row for row in rows), name


def test_assumed_joints_are_said_below_the_table_and_counted_nowhere(plain_page: str) -> None:
    joint = AssumedJoint(name="elbow_l", anatomy="elbow_l", child=2, share=0.4, place=(8.6, 1.4, 0.0), source="proportions")
    text = page(assumed_joints=AssumedJoints(joints=(joint,)))
    inner, outer = spider().names[spider().parents[2]], spider().names[2]
    said = f"Assumed, not found: left elbow, at 40 % of the bone from {inner} to {outer}, by usual proportions."
    assert said in text
    assert 'class="assumed"' not in plain_page
    assert facts(text) == facts(plain_page)
    assert (listed(text, "verdict"), listed(text, "notes")) == (listed(plain_page, "verdict"), listed(plain_page, "notes"))


def test_truth_has_a_chapter_only_where_there_is_one(plain_page: str) -> None:
    assert "truth" not in headings(plain_page)
    content = page(evaluation=judged(spider()))
    assert "truth" in headings(content)
    assert "1 of 2 joints found" in content
    assert "elbow &lt;i&gt;" in content
    assert "missing" in content


def test_result_in_order_is_good_and_has_no_reasons_and_no_notes() -> None:
    leaves = artifacts()["leaves"].model_copy(update={"positions": np.zeros((4, 12, 3))})
    text = page(leaves=leaves)
    assert 'class="verdict good"' in text
    assert "good: the skinned mesh follows the input in all 12 frames" in text
    assert (listed(text, "verdict"), listed(text, "notes")) == ([], [])


def test_verdict_names_frames_and_joints_as_people_call_them() -> None:
    body = spider(support=np.where(np.array(spider().names) == "knee", 2, 12))
    anatomy = tuple("knee_l" if name == "knee" else "" for name in body.names)
    content = artifacts(body)
    far = content["mesh"][7].model_copy(update={"vertices": content["mesh"][7].vertices + [5.0, 0.0, 0.0]})
    text = page(skeleton=body, joint_names=plain(body, anatomy=anatomy), mesh={**content["mesh"], 7: far},
                frame_confidence=confident(body.frames, failed=(3, 4)))  # fmt: skip
    assert 'class="verdict except"' in text
    sentences = listed(text, "verdict")
    assert any(
        "wrong in frame 7" in sentence and "of the body's size away from the input" in sentence for sentence in sentences
    )
    assert "alignment failed in frames 3–4: the body does not fit the input there" in sentences
    assert any(sentence.startswith("left knee: few frames support it") for sentence in sentences)
    assert 'data-frame="7"' in text


def test_notes_tell_of_frames_and_join_what_is_alike() -> None:
    content = artifacts()
    cleaned = Cleaning(components=2, components_kept=1)
    removed = {f: m.model_copy(update={"cleaning": cleaned} if f == 7 else {}) for f, m in content["mesh"].items()}
    begins = np.arange(0, 12, 2)
    many = content["intervals"].model_copy(update={"begin": begins, "end": begins + 1, "cues": (("leaves",),) * 5})
    sentences = listed(
        page(mesh=removed, intervals=many, frame_confidence=confident(spider().frames, unreliable={9: 0.12})), "notes"
    )
    assert "components apart from the body were removed in frame 7" in sentences
    assert "alignment partly unreliable in frame 9: up to 12% of the body is hidden or does not fit" in sentences
    assert [text for text in sentences if "short" in text] == [
        "6 short intervals, of fewer than 5 frames: from frame 0, 2, 4, 6, 8, 10 on"
    ]


def test_body_without_joints_is_not_to_be_used() -> None:
    whole = spider()
    kinds = tuple("leaf" if kind == "joint" else kind for kind in whole.kinds)
    content = page(skeleton=spider(kinds=kinds))
    assert 'class="verdict unusable"' in content
    assert listed(content, "verdict")[0] == "no joints: no part of the body turns against another"
    assert "0 joints in 12 frames" in content


def test_handle_of_the_surface_is_noted_and_a_skin_far_from_the_meshes_is_not_to_be_used(plain_page: str) -> None:
    assert not any("handle" in text for text in listed(plain_page, "notes"))
    ring = trimesh.creation.torus(3.0, 1.0, major_sections=24, minor_sections=12)
    count = len(ring.vertices)
    zero = np.zeros((count, 4))
    body = spider(
        vertices=np.array(ring.vertices), faces=ring.faces.astype(np.int32), label=np.zeros(count, np.int32),
        influence=zero.astype(np.int32), weight=zero + [1, 0, 0, 0],
    )  # fmt: skip
    grows = {f: m.model_copy(update={"vertices": m.vertices * (1 + 0.1 * f)}) for f, m in artifacts(body)["mesh"].items()}
    content = page(skeleton=body, mesh=grows)
    assert any("1 handle, where limbs touch or the body forms a ring" in text for text in listed(content, "notes"))
    assert any("does not explain the motion" in text for text in listed(content, "verdict"))


def test_sequence_of_two_frames_is_warned_of() -> None:
    two = {name: getattr(spider(), name)[:2] for name in ("frames", "positions", "rotation", "confidence")}
    assert any(text.startswith("only 2 frames") for text in listed(page(skeleton=spider(**two)), "verdict"))


def test_alignment_is_drawn_only_where_something_was_aligned(plain_page: str) -> None:
    assert "so nothing had to be aligned" in plain_page
    assert "Distance of the aligned mesh from every frame" in page(**artifacts(anew=True))


def test_same_run_is_the_same_page_to_the_byte(plain_page: str) -> None:
    assert page() == plain_page


@pytest.mark.parametrize("field", ["title", "unit", "names"])
def test_no_word_from_outside_becomes_markup(field: str) -> None:
    bad = "</script><script>alert(1)</script>\n<img src=x onerror=alert(1)>$\\frac$ & {{run}}"
    if field == "title":
        content = page(title=bad)
    elif field == "unit":
        sequence = artifacts()["sequence"].model_copy(update={"unit": bad})
        content = page(skeleton=spider(unit=bad), sequence=sequence)
    else:
        content = page(skeleton=spider(names=(bad, *spider().names[1:])))
    assert "<script>alert" not in content
    assert "<img src=x" not in content
    assert content.count(RUN) == 1, "the record of the run has one place"


def test_page_is_whole_and_asks_for_nothing(plain_page: str) -> None:
    assert plain_page.startswith("<!doctype html>")
    assert plain_page.rstrip().endswith("</html>")
    assert not re.search(r'(src|href)="(?!data:|#)', plain_page)


def test_joints_have_their_expected_error_beside_them_where_it_is_known() -> None:
    body = spider()
    bars = bars_of(body)
    text, j = page(), body.kinds.index("joint")
    assert "expected error" in text
    assert f"{bars.expected[j]:.2g} (90 %: {bars.bound[j]:.2g})" in text
    assert "surface offset" in text
    assert f"<td>{bars.surface_offset[j]:.2g}" in text
    unknown = page(error_bars=unknown_error_bars(body))
    assert "expected error" not in unknown
    assert "surface offset" not in unknown


def test_table_of_joints_says_which_of_them_the_shape_alone_shows() -> None:
    bars, j = bars_of(spider()), spider().kinds.index("joint")
    alone = bars.model_copy(update={"evidence": tuple("shape" if k == j else known for k, known in enumerate(bars.evidence))})
    assert page(error_bars=alone).count("<td>shape</td>") == 1
    assert "<td>motion</td>" in page(error_bars=alone)
    assert "<td>motion</td>" not in page(), "no such column where all joints are known by motion"
