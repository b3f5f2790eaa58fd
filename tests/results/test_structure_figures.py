"""Figures of the structure: chapters whose pictures are complete files."""

from types import SimpleNamespace
from typing import get_args

import numpy as np
import pytest
from matplotlib.text import Text
from results.plain_names import plain
from results.rigged_bodies import spider
from results.sample_derivation import parts_of, reference_of, tree_of
from results.sample_report import derived

from kinetree.schemas.array import Artifact
from kinetree.schemas.results.structure_figures import StructureFigures
from kinetree.schemas.structure.first_tree import Drop
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.page.document import rendered
from kinetree.tasks.results.plots.derivation import REASONS, cones, elimination, lengths, merging, structure

FIGURES = (cones, merging, elimination, structure, lengths)


def of(body: Skeleton) -> StructureFigures:
    return derived(body)


def fetched(body: Skeleton, parts: RigidParts, tree: KinematicTree) -> dict[str, Artifact]:
    """What the pictures read, by name."""
    derived = {"reference": reference_of(body), "rigid_parts": parts, "kinematic_tree": tree}
    return {"skeleton": body, "joint_names": plain(body), **derived}


def words(body: Skeleton, parts: RigidParts, tree: KinematicTree) -> list[str]:
    """All text of every figure."""
    artifacts = fetched(body, parts, tree)
    figures = [draw(lambda name, frame=None: artifacts[name], []) for draw in FIGURES]
    return [" ".join(text.get_text() for text in figure.findobj(Text)) for figure in figures]


def test_every_picture_is_a_file_of_its_kind_and_variation_is_that_of_the_tree() -> None:
    body = spider()
    figures = of(body)
    for chapter in figures.chapters:
        files = figures.picture_files(chapter)
        assert len(files) == len(chapter.pictures) == len(FIGURES)
        assert all(f.startswith(b"<?xml") for f in files)
    assert figures.end[-1] == len(figures.content)
    np.testing.assert_array_equal(figures.length_variation, tree_of(body).length_variation)


def test_figures_are_those_of_the_finished_skeleton() -> None:
    """They are drawn before poses are refined, and show none."""
    body = spider()
    artifacts = fetched(body, parts_of(body), tree_of(body))
    drawn = [rendered(draw(lambda name, frame=None: artifacts[name], [])) for draw in FIGURES]
    assert b"".join(drawn) == of(body).content.tobytes()


def test_same_derivation_gives_the_same_bytes() -> None:
    assert of(spider()) == of(spider())


def test_pictures_count_what_was_cut_removed_and_dropped() -> None:
    body = spider()
    parts, tree = parts_of(body), tree_of(body)
    text = words(body, parts, tree)
    assert f"first cut: {int(parts.initial.max()) + 1} parts" in text[2]
    assert f"2 removed, {len(parts.origin)} parts at the end" in text[2]
    assert "crossed: 1 dropped (1 slides)" in text[3]
    assert f"{body.kinds.count('joint')} joints left" in text[3]


def test_parts_stand_where_the_tree_has_them_and_not_where_the_first_cut_has() -> None:
    body = spider()
    parts, tree = parts_of(body), tree_of(body)
    one = RigidParts(**{name: getattr(parts, name) for name in RigidParts.model_fields} | {"label": np.zeros_like(parts.label)})
    before = structure(fetched(body, one, tree).__getitem__, []).axes[0]
    (squares,) = (line.get_xydata() for line in before.lines if line.get_marker() == "s")
    assert len(np.unique(squares.round(6), axis=0)) == len(squares) == len(tree.joint_of_part) - 1


def test_picture_says_whose_tree_it_is_and_its_titles_stand_side_by_side() -> None:
    body = spider()
    parts, tree = parts_of(body), tree_of(body)
    reasons = [(k, reason) for k, reason in enumerate(REASONS)]
    other = SimpleNamespace(**{**vars(tree), "cut_frame": 9, "dropped": reasons, "in_tree": tree.in_tree})
    for shown, has in ((tree, False), (other, True)):
        titles = [axes.get_title() for axes in structure(fetched(body, parts, shown).__getitem__, []).axes]
        assert ("parts of the cut in frame 9" in "".join(titles)) == has
        assert max(len(line) for line in titles[0].splitlines()) <= 64
    assert all(words in titles[0].replace("\n", " ") for words in REASONS.values())


def test_every_reason_for_which_parts_are_dropped_has_words() -> None:
    reasons = get_args(get_args(Drop)[1])
    assert set(REASONS) == set(reasons)


@pytest.mark.parametrize("removed", [0, 2])
def test_pictures_say_where_there_is_nothing_to_see(removed: int) -> None:
    body = spider()
    parts, tree = parts_of(body), tree_of(body)
    none = {"tip": np.zeros(0, int), "run": np.zeros((0, 6), int), "merge": np.zeros((0, 6))}
    outside = np.full(len(body.vertices), -1)
    fields = {name: getattr(parts, name) for name in RigidParts.model_fields}
    bare = RigidParts(
        **{**fields, **none, "cone": outside, "ring": outside, "removed": parts.removed[:removed], "cost": parts.cost[:removed]}
    )
    text = words(body, bare, tree)
    assert "no cones" in text[0]
    assert "no cones" in text[1]
    assert f"{removed} removed" in text[2]
