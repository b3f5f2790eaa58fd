"""Laws of a node's name: what is written is read back, short forms mean the same, and anything else is refused in words."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import UnknownNodeError
from kinetree.pipeline.node import Node, label, parse, project
from kinetree.tasks import METHODS

GRAPH = METHODS["mesoscopic"]


@given(st.sampled_from(GRAPH.tasks), st.data())
def test_label_is_read_back(task, data):
    node = Node(task.name, tuple(data.draw(st.integers(0, 10**17)) for _ in task.over))
    assert parse(label(node, task.over), GRAPH) == node


def test_nodes_are_written_with_their_dimensions():
    assert label(Node("mesh", (3,)), ("frame",)) == "mesh[frame=3]"
    assert label(Node("cone", (1, 0)), ("interval", "cone")) == "cone[interval=1,cone=0]"
    assert label(Node("sequence"), ()) == "sequence"


@pytest.mark.parametrize("text", ["mesh[frame=3]", "mesh[3]", " mesh [ frame = 3 ] ", "mesh[03]", "mesh[3,]"])
def test_short_and_loose_forms_mean_the_same(text):
    assert parse(text, GRAPH) == Node("mesh", (3,))


@pytest.mark.parametrize("text", ["sequence", "sequence[]", " sequence "])
def test_task_without_index_needs_none(text):
    assert parse(text, GRAPH) == Node("sequence")


@pytest.mark.parametrize(
    "text",
    ["mesh", "mesh[]", "mesh[1,2]", "mesh[vertex=3]", "mesh[frame=-1]", "mesh[frame=x]", "mesh[frame=1.0]", "mesh[frame=]",
     "mesh[frame=" + "9" * 5000 + "]", "mesh[frame=²]", "mesh[frame==3]", "mesh[frame=3][frame=3]"],
)  # fmt: skip
def test_wrong_index_is_refused_with_the_right_form(text):
    with pytest.raises(UnknownNodeError) as refused:
        parse(text, GRAPH)
    assert str(refused.value) == f"{text!r}: a node of mesh is written mesh[frame=…]"


@pytest.mark.parametrize(
    "text", ["", "[3]", "mesh[3", "mesh]", "../mesh", "mesh[3] extra", "a b", "\x1b[31mmesh", "mesh\n[red]x"]
)
def test_what_is_no_node_is_refused_with_an_example(text):
    with pytest.raises(UnknownNodeError) as refused:
        parse(text, GRAPH)
    assert str(refused.value) == f"{text!r}: not a node; write a task, or a task with its index: source[frame=3]"


def test_mistyped_task_is_refused_with_the_nearest():
    with pytest.raises(UnknownNodeError, match=r"^no task 'mehs'; did you mean 'mesh'\?$"):
        parse("mehs[3]", GRAPH)


def test_projection_keeps_the_dimensions_asked_for():
    assert project((4, 7), ("interval", "frame"), ("frame",)) == (7,)
    assert project((4, 7), ("interval", "frame"), ("frame", "interval")) == (7, 4)
    assert project((4, 7), ("interval", "frame"), ()) == ()
