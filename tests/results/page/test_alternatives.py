"""Alternative texts say what a picture shows of this run."""

import re
from types import SimpleNamespace

import numpy as np
from results.rigged_bodies import spider
from results.sample_derivation import parts_of, tree_of
from results.sample_report import page_artifacts

from kinetree.schemas.results.excerpt import ExcerptParams
from kinetree.schemas.results.report import ReportParams
from kinetree.tasks.results.page.alternatives import (
    angles_words,
    confidence_words,
    elimination_words,
    structure_words,
    tree_words,
)
from kinetree.tasks.results.plots.motion import joint_angles
from kinetree.tasks.results.report import report


def test_the_joint_that_turns_most_is_named_with_its_frame() -> None:
    body = spider()
    total = joint_angles(body)
    arm = body.names.index("arm")
    text = angles_words(body, body.names, total)
    assert f"arm {total[:, arm].max():.0f}° in frame {body.frames[int(total[:, arm].argmax())]}" in text


def test_the_frame_of_least_confidence_is_named() -> None:
    body = spider()
    confidence = np.array(body.confidence)
    confidence[3, body.names.index("knee")] = 0.125
    assert "knee 0.12 in frame 3" in confidence_words(spider(confidence=confidence), body.names)


def test_the_tree_is_told_from_its_root() -> None:
    assert tree_words(spider(), spider().names).startswith("trunk carries arm, tail, knee; arm carries hand")


def test_pieces_of_one_part_count_once_and_are_named() -> None:
    parts = parts_of(spider())
    left, origin = len(parts.origin), np.array(parts.origin)
    assert f"{left} are left, {len(parts.removed)} removed." in elimination_words(parts)
    origin[-1] = origin[0]
    halved = SimpleNamespace(**{**vars(parts), "origin": origin})
    assert elimination_words(halved).endswith(f"{left - 1} are left, {len(parts.removed)} removed. Cut apart of those left: 1.")
    origin[-2] = origin[0]
    assert elimination_words(SimpleNamespace(**{**vars(parts), "origin": origin})).endswith("Cut apart of those left: 1.")


def test_a_tree_of_another_cut_than_the_first_says_whose_it_is() -> None:
    body, tree = spider(), tree_of(spider())
    own = structure_words(body, tree)
    assert own.endswith(f"beside it the tree with {body.kinds.count('joint')} joints.")
    for is_given, why in (
        (True, "with which other cuts agree most"),
        (False, "with which other cuts, and both sides of the body, agree more"),
    ):
        other = structure_words(body, SimpleNamespace(**{**vars(tree), "cut_frame": 9, "is_given": is_given}))
        assert other == f"{own} It is of the cut in frame 9, {why}."


def test_every_picture_of_a_page_says_more_than_its_caption() -> None:
    text = report(**page_artifacts(ExcerptParams(frames=4, views=1)), params=ReportParams(title="")).text.tobytes().decode()
    figures = re.findall(r'<img alt="(.*?)" src.*?<figcaption>(.*?)</figcaption>', text, re.DOTALL)
    assert len(figures) > 8
    for alternative, caption in figures:
        assert alternative
        assert alternative != caption
        assert re.search(r"\d|No |carries", alternative)
