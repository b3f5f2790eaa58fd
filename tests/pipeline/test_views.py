"""Laws of views: functions by artifact class, the class before its bases, imported when somebody looks."""

import sys

import pytest

from kinetree.errors import GraphError
from kinetree.pipeline import views
from kinetree.pipeline.identity.own_code import code_parts
from kinetree.pipeline.output import output
from kinetree.schemas.array import Artifact
from kinetree.tasks import VIEWS
from kinetree.tasks.methods import METHODS

WORDED = {"evaluation_figures", "paper_figures", "reeb_figures", "report"}
"""Tasks whose artifacts hold sentences for people."""


class Stone(Artifact):
    """What is seen."""

    weight: float = 1.0
    """Its weight."""


class Gem(Stone):
    """A stone with words of its own."""


class Pebble(Stone):
    """A stone without."""


class Dust(Artifact):
    """Nothing to see."""


@views.remarks_of(Stone)
def stone_remarks(stone: Stone) -> tuple[str, ...]:
    return (f"weighs {stone.weight:g}",)


@views.remarks_of(Gem)
def gem_remarks(gem: Gem) -> tuple[str, ...]:
    return ("shines",)


@views.text_of(Stone)
def stone_text(stone: Stone) -> tuple[str, ...]:
    return ("a stone",)


@views.files_of(Stone)
def stone_files(stone: Stone, index: tuple[int, ...]) -> dict[str, bytes]:
    return {f"stone_{index[0]}.txt": b"stone"}


@views.page_of(Gem, "gem.html")
def gem_page(gem: Gem, run: views.Run) -> bytes:
    return str(run["run"]).encode()


views.leave_group(Pebble, "pebble.zarr")


def test_view_of_the_class_comes_before_that_of_its_base() -> None:
    assert views.remarks(Gem()) == ("shines",)
    assert views.remarks(Pebble(weight=3)) == views.remarks(Stone(weight=3)) == ("weighs 3",)
    assert views.text(Gem()) == ("a stone",)
    assert views.files(Gem(), (7,)) == {"stone_7.txt": b"stone"}


def test_text_may_speak_of_other_results_where_there_are_any() -> None:
    class Heap(Dust):
        """What lies about."""

    @views.text_of(Heap, Stone)
    def heap_text(heap: Heap, stone: Stone | None) -> tuple[str, ...]:
        return (f"dust of {stone.weight:g}" if stone else "dust",)

    assert views.text(Heap()) == ("dust",)
    assert views.text(Heap(), lambda cls: cls(weight=3) if cls is Stone else None) == ("dust of 3",)


def test_what_nobody_registered_is_empty() -> None:
    assert views.remarks(Dust()) == views.text(Dust()) == ()
    assert views.files(Dust(), ()) == {}
    assert (views.summary(Dust()), views.has_summary(Dust)) == ({}, False)
    assert (views.group_name(Dust), views.page_name(Dust), views.leaves_files(Dust)) == ("", "", False)
    with pytest.raises(GraphError, match=r"^Dust has no page that tells of a run$"):
        views.page(Dust(), {})


def test_names_under_which_artifacts_are_left_are_told_by_class() -> None:
    assert (views.group_name(Pebble), views.group_name(Stone)) == ("pebble.zarr", "")
    assert (views.page_name(Gem), views.page_name(Stone)) == ("gem.html", "")
    assert views.page(Gem(), {"run": "noon"}) == b"noon"
    assert [output.leaves(cls) for cls in (Stone, Gem, Pebble, Dust)] == [True, True, True, False]


def test_registered_function_stays_the_plain_function_it_was() -> None:
    assert stone_remarks(Stone(weight=2)) == ("weighs 2",)


def test_two_views_of_one_kind_and_class_are_refused_naming_both() -> None:
    def other(stone: Stone) -> tuple[str, ...]:
        return ()

    with pytest.raises(GraphError) as refused:
        views.remarks_of(Stone)(other)
    here = f"{__name__}.test_two_views_of_one_kind_and_class_are_refused_naming_both.<locals>.other"
    assert str(refused.value) == f"two views give the remarks of Stone: {__name__}.stone_remarks and {here}"
    assert views.remarks(Stone()) == ("weighs 1",)


def test_modules_of_views_are_imported_when_somebody_looks(tmp_path, monkeypatch) -> None:
    (tmp_path / "late_views.py").write_text(
        "from kinetree.pipeline.views import remarks_of\n"
        "from kinetree.schemas.array import Artifact\n\n\n"
        "class Late(Artifact):\n    pass\n\n\n"
        "@remarks_of(Late)\ndef late_remarks(late):\n    return ('late',)\n"
    )
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(views, "_PROVIDED", dict(views._PROVIDED))
    views.provide("late_views")
    assert "late_views" not in sys.modules
    views.remarks(Dust())
    late = sys.modules.pop("late_views")
    assert views.remarks(late.Late()) == ("late",)


@pytest.mark.parametrize("method", METHODS)
def test_no_task_reaches_a_sentence_but_those_that_put_sentences_into_artifacts(method) -> None:
    reaching = {t.name for t in METHODS[method].tasks if set(code_parts(t.module, t.name)) & {*VIEWS, "kinetree.tasks.views"}}
    assert reaching <= WORDED
    assert "report" in reaching
