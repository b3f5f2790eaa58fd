"""Laws of the graph: tasks come after what they read, and a graph that cannot work is refused at import, naming both places."""

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

import networkx as nx
import pytest

from kinetree.errors import CycleError, GraphError, MissingWriterError, TwoWritersError, UnknownNodeError
from kinetree.pipeline.graph import Graph
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.task import Previous, origin, task
from kinetree.schemas.array import Artifact, Params
from kinetree.tasks import METHODS


class SeedParams(Params):
    """Nothing to say."""


class Seed(Artifact):
    """One a day."""


class Leaf(Artifact):
    """One a day."""


class Branches(Artifact):
    """Opens branches, and the days of each."""

    opens: ClassVar[tuple[str, ...]] = ("branch", "branch/day")


class Fruit(Artifact):
    """One a branch."""


class Harvest(Artifact):
    """One."""


class Order(Artifact):
    """A traversal."""


@origin(over="day")
def seed(params: SeedParams, files: Files) -> Mapping[int, Seed]:
    """Sown."""
    return {}


@task(over="day")
def leaf(seed: Seed) -> Leaf:
    """Grows (2014, Sec. 2)."""
    return Leaf()


@task()
def branches(leaf: Mapping[int, Leaf]) -> Branches:
    """Branch."""
    return Branches()


@task(over="branch")
def fruit(leaf: tuple[Leaf, ...], branches: Branches) -> Fruit:
    """Ripens."""
    return Fruit()


@task()
def harvest(fruit: tuple[Fruit, ...]) -> Harvest:
    """Gathers."""
    return Harvest()


class Years(Artifact):
    """Opens years, each with all days, and orders them."""

    opens: ClassVar[tuple[str, ...]] = ("year", "year/day")
    orders: ClassVar[str] = "year"


class Season(Artifact):
    """One a year."""


class Sapling(Artifact):
    """One a day of a year."""


@task()
def year(seed: Mapping[int, Seed]) -> Years:
    """Counts."""
    return Years()


@task(over="year", along=Years)
def season(sapling: Previous[tuple[Sapling, ...]]) -> Season:
    """Knows the saplings of last year."""
    return Season()


@task(over="year/day", along=Years)
def sapling(seed: Seed, season: Season, before: "Sapling | None") -> Sapling:
    """Grows in its season."""
    return Sapling()


ALL = (harvest, fruit, branches, leaf, seed)


def names(graph):
    return [t.name for t in graph.tasks]


def refusal(error, *tasks):
    with pytest.raises(GraphError) as refused:
        Graph.of(tasks)
    assert type(refused.value) is error
    return str(refused.value)


def test_tasks_come_after_what_they_read_whatever_order_they_were_told_in():
    assert names(Graph.of(ALL)) == ["seed", "leaf", "branches", "fruit", "harvest"]
    assert names(Graph.of(ALL[::-1])) == names(Graph.of(ALL))


def test_gather_takes_the_members_of_this_index_where_such_a_space_is_opened():
    graph = Graph.of(ALL)
    assert graph.gathered_space(fruit, fruit.arguments[0]) == ("branch", "day")
    assert graph.gathered_space(branches, branches.arguments[0]) == ("day",)
    assert graph.gathered_space(harvest, harvest.arguments[0]) == ("branch",)
    assert graph.gathered_space(leaf, leaf.arguments[0]) == ("day",)


def test_two_writers_of_one_artifact_are_refused_naming_both():
    @task(over="day")
    def weed(seed: Seed) -> Leaf:
        """Grows too."""
        return Leaf()

    assert refusal(TwoWritersError, seed, leaf, weed) == f"two tasks write Leaf: {leaf.where} and {weed.where}"


def test_two_tasks_of_one_name_are_refused_naming_both():
    def twin():
        @task(over="day")
        def leaf(seed: Seed) -> Fruit:
            """Another of the name."""
            return Fruit()

        return leaf

    other = twin()
    assert refusal(TwoWritersError, seed, leaf, other) == f"two tasks are named leaf: {leaf.where} and {other.where}"


def test_missing_writer_is_refused_naming_the_reader_and_the_class():
    message = refusal(MissingWriterError, leaf)
    assert message == f"leaf ({leaf.where}): argument seed is Seed ({__name__}), which no task writes"


def test_traversal_that_no_task_writes_is_refused():
    @task(over="day", along=Order)
    def vine(before: "Fruit | None") -> Fruit:
        """Climbs."""
        return Fruit()

    message = refusal(MissingWriterError, seed, vine)
    assert message == f"vine ({vine.where}): the traversal it goes along is Order ({__name__}), which no task writes"


def test_a_block_that_no_task_with_these_params_has_is_refused():
    @task(block="seeds")
    def sown(seed: Seed, params: SeedParams) -> Fruit:
        """Grows."""
        return Fruit()

    message = refusal(GraphError, seed, sown)
    assert message == f"sown ({sown.where}): is set by the block seeds, but there is no task of that name with SeedParams"
    with pytest.raises(GraphError, match="is set by the block seed, but takes no params"):
        task(over="day", block="seed")(leaf.function)


def test_a_block_with_more_settings_than_its_task_reads_extends_what_it_reads():
    class Wider(SeedParams):
        water: float = 1.0

    class Other(Params):
        water: float = 1.0

    def sown(params: SeedParams) -> Seed:
        """Grows."""
        return Seed()

    assert task(block=Wider)(sown).sets is Wider
    assert task(block=Wider)(leaf.function).sets is Wider
    with pytest.raises(GraphError, match="its block is set by Other, which does not extend SeedParams"):
        task(block=Other)(sown)


def test_cycle_is_refused_naming_every_place():
    @task()
    def egg(harvest: Harvest) -> Order:
        """First."""
        return Order()

    @task()
    def hen(order: Order) -> Harvest:
        """First."""
        return Harvest()

    message = refusal(CycleError, egg, hen)
    assert message.startswith("tasks wait for each other: ")
    assert f"egg ({egg.where})" in message
    assert f"hen ({hen.where})" in message
    assert message.count("→") == 2


def test_ring_that_goes_through_the_previous_member_is_no_cycle():
    graph = Graph.of((season, sapling, year, seed))
    assert names(graph) == ["seed", "year", "season", "sapling"]
    assert graph.before(season) == (year,)
    assert graph.behind(season) == (sapling,)
    assert graph.reads(season) == (year, sapling)
    assert names(graph.until(["season"])) == ["seed", "year", "season", "sapling"]


def test_ring_that_the_previous_member_does_not_cut_is_refused():
    @task(over="year", along=Years)
    def season(sapling: tuple[Sapling, ...], before: "Season | None") -> Season:
        """Waits for the saplings of its own year."""
        return Season()

    message = refusal(CycleError, seed, year, season, sapling)
    assert message.startswith("tasks wait for each other: ")
    assert f"season ({season.where})" in message
    assert f"sapling ({sapling.where})" in message


def test_previous_of_what_has_no_such_dimension_is_refused():
    @task(over="year/day", along=Years)
    def sapling(seed: Seed | None) -> Sapling:
        """There is one seed a day, whatever the year."""
        return Sapling()

    assert refusal(GraphError, seed, year, sapling) == (
        f"sapling ({sapling.where}): argument seed is read at the previous year, but seed ({seed.where}) writes Seed per day"
    )

    @task(over="year/day", along=Years)
    def shoot(years: Years | None) -> Sapling:
        """There is one list of years."""
        return Sapling()

    assert refusal(GraphError, seed, year, shoot).endswith(f"but year ({year.where}) writes Years once")


def test_traversal_that_is_ordered_at_a_finer_index_is_refused():
    @task(over="day")
    def order(seed: Seed) -> Order:
        """One a day."""
        return Order()

    @task(over="year", along=Order)
    def season(before: "Season | None") -> Season:
        """Which day's?"""
        return Season()

    assert refusal(GraphError, seed, year, order, season) == (
        f"season ({season.where}) goes along Order, but order ({order.where}) writes one per day"
    )


@pytest.mark.parametrize("form", [Harvest, tuple[Harvest, ...], Mapping[int, Harvest]], ids=str)
def test_task_that_waits_for_itself_is_refused(form):
    def snake(tail) -> Harvest:
        return Harvest()

    snake.__annotations__["tail"] = form
    snake_task = task()(snake)
    message = refusal(CycleError, snake_task)
    assert message.startswith(f"snake ({snake_task.where}) waits for itself: argument tail is Harvest, which it writes; ")
    assert "write Harvest | None and say along" in message


def test_traversal_ordered_by_what_is_traversed_is_refused():
    @task(over="day", along=Fruit)
    def vine(before: "Fruit | None") -> Fruit:
        """Climbs itself."""
        return Fruit()

    assert "waits for itself: the traversal it goes along is Fruit" in refusal(CycleError, seed, vine)


def test_space_whose_members_depend_on_what_runs_over_it_is_a_cycle():
    @task()
    def stubs(fruit: tuple[Fruit, ...]) -> Branches:
        """Branches that are known when their fruit is."""
        return Branches()

    @task(over="branch")
    def apple() -> Fruit:
        """Ripens."""
        return Fruit()

    assert "apple" in refusal(CycleError, stubs, apple)


def test_one_where_there_are_many_is_refused_with_the_remedy():
    @task()
    def basket(leaf: Leaf) -> Harvest:
        """Forgets the tuple."""
        return Harvest()

    assert refusal(GraphError, seed, leaf, basket) == (
        f"basket ({basket.where}): argument leaf is one Leaf, but leaf ({leaf.where}) writes one per day;"
        " write tuple[Leaf, ...] to gather them"
    )


@pytest.mark.parametrize("form", [tuple[Leaf, ...], Mapping[int, Leaf]], ids=str)
def test_gather_where_there_is_one_is_refused(form):
    def pick(leaf) -> Fruit:
        return Fruit()

    pick.__annotations__["leaf"] = form
    pick_task = task(over="day")(pick)
    message = refusal(GraphError, seed, leaf, pick_task)
    assert message == f"pick ({pick_task.where}): argument leaf gathers Leaf, of which there is one at its index"


def test_mapping_over_two_dimensions_at_once_is_refused():
    @task(over="branch/day")
    def bud(leaf: Leaf) -> Order:
        """One a day of a branch."""
        return Order()

    @task()
    def bouquet(bud: Mapping[int, Order]) -> Harvest:
        """By which number?"""
        return Harvest()

    message = refusal(GraphError, seed, leaf, branches, bud, bouquet)
    assert message.endswith("argument bud maps from one number, but gathers over branch/day; use a tuple")


@pytest.mark.parametrize("over", ["night", "branch", "day/hour", "day/", "/day", "day/day"])
def test_space_that_no_task_opens_is_refused(over):
    @task(over=over)
    def owl() -> Fruit:
        """Where?"""
        return Fruit()

    message = refusal(MissingWriterError, seed, owl)
    assert message.startswith(f"owl ({owl.where}) runs over {over}, but no task opens ")


def test_space_that_two_tasks_open_is_refused_naming_both():
    class Twigs(Artifact):
        """Opens branches too."""

        opens: ClassVar[tuple[str, ...]] = ("branch",)

    @task()
    def twigs() -> Twigs:
        """Opens branches too."""
        return Twigs()

    message = refusal(TwoWritersError, seed, leaf, branches, twigs)
    assert message == f"two tasks open branch: {branches.where} and {twigs.where}"


def test_task_that_opens_a_space_beside_its_own_is_refused():
    @task(over="day")
    def grafts(seed: Seed) -> Branches:
        """Every day opens the same branches."""
        return Branches()

    message = refusal(GraphError, seed, grafts)
    assert message == f"grafts ({grafts.where}) runs over day and cannot open branch"


def test_until_keeps_what_a_task_needs_and_no_more():
    graph = Graph.of(ALL)
    assert names(graph.until(["leaf"])) == ["seed", "leaf"]
    assert names(graph.until(["branches"])) == ["seed", "leaf", "branches"]
    assert names(graph.until(["leaf", "harvest"])) == names(graph)


def test_unknown_task_is_refused_with_the_nearest():
    graph = Graph.of(ALL)
    with pytest.raises(UnknownNodeError, match=r"^no task 'leaff'; did you mean 'leaf'\?$"):
        graph.until(["leaff"])
    with pytest.raises(UnknownNodeError, match=r"^no task 'xyz'; there are: branches, fruit, harvest, leaf, seed$"):
        graph.task("xyz")


def test_a_task_of_an_earlier_version_is_refused_with_its_name_of_today():
    graph = replace(Graph.of(ALL), renamed={"leaves": "leaf", "bark": "trunk", "xyz": "seed"})
    for look in (graph, graph.until(["branches"])):
        with pytest.raises(UnknownNodeError, match=r"^no task 'xyz'; it is now 'seed'$"):
            look.task("xyz")
        with pytest.raises(UnknownNodeError, match=r"^no task 'leaves'; it is now 'leaf'$"):
            look.until(["leaves"])
    with pytest.raises(UnknownNodeError, match=r"^no task 'bark'; there are: "):
        graph.task("bark")


def test_graph_as_networkx_has_typed_nodes_and_edges():
    drawn = Graph.of(ALL).networkx()
    assert nx.is_directed_acyclic_graph(drawn)
    assert drawn.nodes["leaf"] == {
        "over": "day", "artifact": "Leaf", "params": None, "paper": "2014, Sec. 2", "summary": "Grows.",
    }  # fmt: skip
    assert drawn.edges["leaf", "fruit"] == {"argument": "leaf", "form": "tuple", "previous": False}
    assert drawn.edges["seed", "leaf"]["form"] == "one"


@pytest.mark.parametrize("method", METHODS)
def test_every_task_of_kinetree_cites_its_paper_in_one_sentence(method):
    for each in METHODS[method].tasks:
        assert each.summary.endswith("."), each.name
        assert each.paper, f"{each.name} ({each.where}) cites no section"
