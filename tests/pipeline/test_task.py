"""Laws of a declaration: every form a signature may have, and every refusal at import in words that name the place."""

import gc
from collections.abc import Mapping
from typing import Annotated, ClassVar, Optional

import pytest

from kinetree.errors import GraphError
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.task import Previous, load, origin, space, task
from kinetree.schemas.array import Artifact, Index, Params


class Stone(Artifact):
    """What is read."""

    weight: float = 1.0
    """Its weight."""


class House(Artifact):
    """What is written."""

    weight: float
    """Its weight."""


class Row(Artifact):
    """An order of houses."""


class Streets(Artifact):
    """An order of streets."""

    orders: ClassVar[str] = "street"


class HouseParams(Params):
    """How to build."""

    floors: int = 1
    """How many."""


def build(*stones, weight=1.0):
    return House(weight=weight)


@task(over="street/house")
def house(one: Stone, some: tuple[Stone, ...], many: Mapping[int, Stone], params: HouseParams) -> House:
    """Builds a house (2014, Sec. 4.2, Eq. 7). It stands.

    And more (2009, Sec. 1).
    """
    return House(weight=one.weight * params.floors)


def test_signature_is_the_place_in_the_graph():
    assert house.name == "house"
    assert house.over == ("street", "house")
    assert house.arguments == (
        Argument("one", Stone, "one"),
        Argument("some", Stone, "tuple"),
        Argument("many", Stone, "mapping"),
    )
    assert (house.params, house.returns, house.along, house.is_origin) == (HouseParams, House, None, False)
    assert house.where.startswith(f"{__file__}:")


def test_task_is_called_as_the_plain_function_it_is():
    assert house(Stone(weight=2), (), {}, HouseParams(floors=3)) == House(weight=6)
    assert house(one=Stone(), some=(), many={}, params=HouseParams()).weight == 1


def test_docstring_tells_summary_and_paper():
    assert house.summary == "Builds a house. It stands."
    assert house.paper == "2014, Sec. 4.2, Eq. 7"

    @task()
    def plain() -> House:
        return House(weight=1)

    assert (plain.summary, plain.paper) == ("", "")


@pytest.mark.parametrize("form", [House | None, None | House, Optional[House], "House | None"], ids=str)  # noqa: UP045
def test_own_artifact_at_the_previous_member(form):
    def grown(before) -> House:
        return before or House(weight=1)

    grown.__annotations__["before"] = form
    assert task(over="house", along=Row)(grown).arguments == (Argument("before", House, "one", previous=True),)


def test_what_others_made_at_the_previous_member():
    def grown(one: Stone | None, some: Previous[tuple[Stone, ...]], many: Previous[Mapping[int, Stone]]) -> House:
        return build(one, *some, *many.values())

    house_task = task(over="street/house", along=Row)(grown)
    assert house_task.arguments == (
        Argument("one", Stone, "one", previous=True),
        Argument("some", Stone, "tuple", previous=True),
        Argument("many", Stone, "mapping", previous=True),
    )
    assert house_task(None, (), {}) == House(weight=1)


def test_traversal_goes_over_the_last_dimension_or_the_one_that_its_artifact_orders():
    def grown(before: House | None) -> House:
        return before or build()

    assert task(over="street/house", along=Row)(grown).traversed == "house"
    assert task(over="street/house", along=Streets)(grown).traversed == "street"
    assert house.traversed == ""


def test_index_is_told_to_a_task_that_asks_for_it():
    @task(over="street/house")
    def numbered(one: Stone, index: Index) -> House:
        return House(weight=one.weight * index[1])

    assert numbered.asks_index
    assert not house.asks_index
    assert numbered.arguments == (Argument("one", Stone, "one"),)
    assert numbered(Stone(weight=2), (1, 3)).weight == 6


def test_annotations_in_quotes_are_read():
    @task()
    def quoted(one: "Stone", some: "tuple[Stone, ...]") -> "House":
        return build(one, *some)

    assert [a.form for a in quoted.arguments] == ["one", "tuple"]


def test_origin_tells_its_members():
    @origin(over="house")
    def found(params: HouseParams, files: Files) -> Mapping[int, Stone]:
        """Finds."""
        return {}

    assert (found.is_origin, found.returns, found.over, found.arguments) == (True, Stone, ("house",), ())


def refusal(function, **declared):
    declare = origin if declared.pop("as_origin", False) else task
    with pytest.raises(GraphError) as refused:
        declare(**declared)(function)
    message = str(refused.value)
    assert message.startswith(f"{function.__name__} ({__file__}:{function.__code__.co_firstlineno}): ")
    return message.partition("): ")[2]


FORMS = (
    "argument x must be an Artifact, tuple[Artifact, ...] or Mapping[int, Artifact], or, at the previous member of a traversal,"
    " House | None, Previous[tuple[Artifact, ...]] or Previous[Mapping[int, Artifact]]"
)


@pytest.mark.parametrize(
    "hint",
    [int, "str", None, list[Stone], tuple[Stone], tuple[Stone, Stone], tuple[int, ...], dict[int, Stone], Mapping[str, Stone],
     Mapping, Stone | int | None, int | None, Stone | House, HouseParams, Artifact | int, type[Stone], Annotated[int, "x"],
     Annotated[tuple[Stone, ...], "x"], Previous[Stone], Previous[Stone | None], Previous[tuple[Stone]], Index, 3],
    ids=repr,
)  # fmt: skip
def test_argument_that_is_no_edge_is_refused(hint):
    def wrong(x) -> House:
        return build(x)

    wrong.__annotations__["x"] = hint
    assert refusal(wrong).startswith(f"{FORMS}; got ")


def test_argument_without_a_type_is_refused():
    def bare(x) -> House:
        return build(x)

    assert refusal(bare) == f"{FORMS}; got None"


@pytest.mark.parametrize("hint", [None, int, tuple[House, ...], House | None, Mapping[int, House]])
def test_task_that_returns_no_artifact_is_refused(hint):
    def nothing(one: Stone):
        return one

    if hint is not None:
        nothing.__annotations__["return"] = hint
    assert refusal(nothing).startswith("the return type must be an Artifact, got ")


@pytest.mark.parametrize("hint", [None, dict, int, Params | None, Stone, HouseParams | None])
def test_params_of_a_wrong_type_are_refused(hint):
    def wrong(params) -> House:
        return build(params)

    if hint is not None:
        wrong.__annotations__["params"] = hint
    assert refusal(wrong).startswith("params must be annotated with a class of Params, got ")


def test_previous_without_a_traversal_and_a_traversal_without_previous_are_refused():
    def grown(before: House | None) -> House:
        return build(before)

    def alone(one: Stone) -> House:
        return build(one)

    def gathered(before: Previous[tuple[House, ...]]) -> House:
        return build(*before)

    message = "a task reads at the previous member exactly if it says along which traversal"
    assert refusal(grown, over="house") == message
    assert refusal(gathered, over="house") == message
    assert refusal(alone, over="house", along=Row) == message


def test_traversal_of_a_dimension_that_the_task_lacks_is_refused():
    def grown(before: House | None) -> House:
        return before or build()

    assert refusal(grown, along=Row) == "goes along Row, but runs once; say over what it runs"
    assert refusal(grown, over="house", along=Streets) == "goes along Streets, which orders street, but runs over house"


def test_index_where_there_is_none_or_of_a_wrong_type_is_refused():
    def once(index: Index) -> House:
        return build()

    def worded(index: str) -> House:
        return build()

    def bare(index) -> House:
        return build()

    assert refusal(once) == "asks for its index, but runs once and has none; say over what it runs"
    assert refusal(worded, over="house") == "index must be annotated with Index, got <class 'str'>"
    assert refusal(bare, over="house") == "index must be annotated with Index, got None"


def test_arguments_that_cannot_be_given_by_name_are_refused():
    def starred(*stones: Stone) -> House:
        return build(*stones)

    def doubled(**stones: Stone) -> House:
        return build(*stones)

    def hidden(one: Stone, /) -> House:
        return build(one)

    for function in (starred, doubled, hidden):
        assert "must have a name of its own; tasks are called by keyword" in refusal(function)


def test_origin_that_reads_artifacts_or_lacks_an_argument_is_refused():
    def reads(params: HouseParams, files: Files, one: Stone) -> Stone:
        return one

    def deaf(params: HouseParams) -> Stone:
        return Stone()

    def blind(files: Files) -> Stone:
        return Stone()

    def asks(params: HouseParams, files: Files, index: Index) -> Stone:
        return Stone()

    assert refusal(reads, as_origin=True) == "an origin takes params and files alone, got one"
    assert refusal(asks, as_origin=True) == "an origin takes params and files alone, got index"
    for function in (deaf, blind):
        assert refusal(function, as_origin=True) == "an origin takes both params and files, one of them is missing"


def test_space_is_a_path_of_dimensions():
    assert space("") == ()
    assert space("frame") == ("frame",)
    assert space("interval/cone") == ("interval", "cone")


def test_worker_finds_a_task_by_its_name():
    found = load("kinetree.tasks.input.mesh:mesh")
    assert (found.name, found.module) == ("mesh", "kinetree.tasks.input.mesh")
    with pytest.raises(GraphError, match=r"^kinetree\.tasks\.input\.mesh:clean is not a task$"):
        load("kinetree.tasks.input.mesh:clean")


def test_no_garbage_is_looked_for_while_a_task_is_imported(tmp_path, monkeypatch):
    (tmp_path / "slow_task.py").write_text("import gc\nbefore = gc.isenabled()\nassert not before\n")
    monkeypatch.syspath_prepend(tmp_path)
    with pytest.raises(GraphError, match="slow_task:before is not a task"):
        load("slow_task:before")
    assert gc.isenabled()
    with pytest.raises(ImportError):
        load("no_such_module:task")
    assert gc.isenabled()


def test_threads_and_retries_that_make_no_sense_are_refused():
    for limits in ({"threads": 0}, {"retries": -1}):
        with pytest.raises(GraphError, match=r"expected at least 1 and 0"):
            task(over="street/house", **limits)(house.function)
