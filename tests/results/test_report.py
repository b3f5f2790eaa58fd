"""The report of a small body: its facts, its warnings, its chapters, and text from outside that must not become markup."""

import re
from html import unescape
from typing import Any

import numpy as np
import pytest
import trimesh
from results.rigged_bodies import skinned, spider
from results.sample_report import artifacts, confident, judged, page_artifacts

from kinetree.schemas.input.mesh import Cleaning
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.excerpt import ExcerptParams
from kinetree.schemas.results.report import RUN, ReportParams
from kinetree.tasks.results.report import report


def page(title: str = "", **changes: Any) -> str:
    arguments = page_artifacts(ExcerptParams(frames=4, views=1), **changes)
    return report(**arguments, params=ReportParams(title=title)).text.tobytes().decode()


def warnings(text: str) -> list[str]:
    """The sentences in the box of warnings."""
    box = re.search(r'<aside class="warnings".*?</aside>', text, re.DOTALL)
    return [unescape(sentence) for sentence in re.findall("<li>(.*?)</li>", box.group())] if box else []


def facts(text: str) -> dict[str, str]:
    items = re.search(r'<ul class="facts">(.*?)</ul>', text, re.DOTALL)
    assert items is not None
    return {name: unescape(value) for name, value in re.findall("<li>(.*?) <b>(.*?)</b></li>", items.group(1))}


def headings(text: str) -> list[str]:
    return re.findall(r'<section id="(\w+)">', text)


@pytest.fixture(scope="module")
def plain() -> str:
    return page()


def test_facts_are_at_the_head_of_the_page(plain: str) -> None:
    content = facts(plain)
    assert (content["frames"], content["joints"], content["intervals"]) == ("12", "2", "2")
    assert (content["unit"], content["frames a second"]) == ("mm", "10")


def test_every_joint_is_in_the_table(plain: str) -> None:
    rows = re.findall("<tr>(.*?)</tr>", plain)
    for name in spider().names:
        assert any(f"<td>{name}</td>" in row for row in rows), name


def test_truth_has_a_chapter_only_where_there_is_one(plain: str) -> None:
    assert "truth" not in headings(plain)
    content = page(evaluation=judged(spider()))
    assert "truth" in headings(content)
    assert "1 of 2 joints found" in content
    assert "elbow &lt;i&gt;" in content
    assert "missing" in content


def test_page_without_warnings_has_no_box_for_them() -> None:
    leaves = artifacts()["leaves"].model_copy(update={"positions": np.zeros((4, 12, 3))})
    assert warnings(page(leaves=leaves)) == []


def test_box_of_warnings_names_frames_and_joints() -> None:
    content = artifacts()
    doubt = confident(spider().frames, failed=(3, 4), unreliable={9: 0.12})
    cleaned = Cleaning(components=2, components_kept=1)
    removed = {f: m.model_copy(update={"cleaning": cleaned} if f == 7 else {}) for f, m in content["mesh"].items()}
    body = spider(support=np.full(len(spider().names), 2))
    sentences = warnings(page(frame_confidence=doubt, mesh=removed, skeleton=body))
    assert "alignment failed in frames 3–4: the aligned body does not fit the mesh there" in sentences
    assert "alignment partly unreliable in frame 9: up to 12% of the body is hidden or does not fit" in sentences
    assert "components apart from the body were removed in frame 7" in sentences
    assert any("supported by fewer than 5 frames" in text and "joints arm, knee" in text for text in sentences)


def test_body_without_joints_says_that_it_is_one_rigid_part() -> None:
    whole = spider()
    kinds = tuple("leaf" if kind == "joint" else kind for kind in whole.kinds)
    content = page(skeleton=spider(kinds=kinds))
    assert any("one rigid part" in text for text in warnings(content))
    assert "0 joints in 12 frames" in content


def test_handle_of_the_surface_and_a_skin_far_from_the_meshes_are_warned_of(plain: str) -> None:
    assert not any("handle" in text or "explain" in text for text in warnings(plain))
    ring = trimesh.creation.torus(3.0, 1.0, major_sections=24, minor_sections=12)
    count = len(ring.vertices)
    zero = np.zeros((count, 4))
    body = spider(
        vertices=np.array(ring.vertices), faces=ring.faces.astype(np.int32), label=np.zeros(count, np.int32),
        influence=zero.astype(np.int32), weight=zero + [1, 0, 0, 0],
    )  # fmt: skip
    one, rest = np.ones(count), skinned(body)
    grows = {
        f: Alignment(vertices=rest[t] * (1 + 0.1 * t), residual=0 * one, stretch=one, confidence=one, uncovered=0.0)
        for t, f in enumerate(body.frames)
    }
    sentences = warnings(page(skeleton=body, alignment=grows))
    assert any("1 handle, where limbs touch or the body forms a ring" in text for text in sentences)
    assert any("does not explain the motion" in text for text in sentences)


def test_sequence_of_two_frames_is_warned_of() -> None:
    two = {name: getattr(spider(), name)[:2] for name in ("frames", "positions", "rotation", "confidence")}
    assert any(text.startswith("only 2 frames") for text in warnings(page(skeleton=spider(**two))))


def test_alignment_is_drawn_only_where_something_was_aligned(plain: str) -> None:
    assert "so nothing had to be aligned" in plain
    assert "Distance of the aligned mesh from every frame" in page(**artifacts(anew=True))


def test_same_run_is_the_same_page_to_the_byte(plain: str) -> None:
    assert page() == plain


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


def test_page_is_whole_and_asks_for_nothing(plain: str) -> None:
    assert plain.startswith("<!doctype html>")
    assert plain.rstrip().endswith("</html>")
    assert not re.search(r'(src|href)="(?!data:|#)', plain)
