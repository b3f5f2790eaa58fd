"""Who may import whom, that every operation has one stem on one shelf behind every door, and that every artifact is read."""

import ast
import re
import sys
from collections.abc import Iterable
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import networkx as nx
import pytest

from kinetree.pipeline import views
from kinetree.pipeline.graph import Graph
from kinetree.tasks import METHODS
from kinetree.tasks.input import INPUT
from kinetree.tasks.methods import DATA_SETS

ROOT = Path(__file__).resolve().parent.parent
SHELVES = ("input", "topology", "registration", "structure", "paper_2014", "paper_2009", "results")
"""From left to right, as data flows."""
FILES = [p for folder in ("errors", "pipeline", "schemas", "tasks") for p in sorted((ROOT / folder).rglob("*.py"))]
NUMERICS = sorted(ROOT.glob("tasks/numerics/**/*.py"))
SCHEMAS = sorted(ROOT.glob("schemas/**/*.py"))
NUMERIC = {"numpy", "scipy", "numba", "networkx", "trimesh", "skimage"}
READERS = {"PIL", "nrrd", "tifffile", "yaml"}
"""What reads the users' own files, beside the numbers."""
ALONE = {
    "dask": {"pipeline/running/launch.py"},
    "distributed": {f"pipeline/running/{stem}.py" for stem in ("clusters", "connections", "own_cluster", "sent_parcels")},
    "zarr": {"pipeline/storage/groups.py"},
}
"""By library, the files that import it: whose scheduler it is, how it is reached, our own workers, and parcels on them."""
SLOW = {"scipy.signal", "scipy.stats"}
"""Take as long to import as all else of scipy."""
ROOMS = ("identity", "storage", "settings", "planning", "running", "inspection", "output", "dataset", "command_line")
"""Folders of the loom: one imports only from those before it."""
LISTS = ("__init__.py", "shelf.py")
"""Where a shelf lists its operations."""
OPERATIONS = [p for shelf in SHELVES for p in sorted(ROOT.glob(f"tasks/{shelf}/*.py")) if p.name not in LISTS]
PRODUCT = re.compile(
    r"\b(mesh|meshes|skeletons?|joints?|bones?|body|bodies|limbs?|scans?|vertex|vertices|geodesics?|kinematic|silhouettes?"
    r"|kinetree\.(tasks|configs|schemas\.(?!array|dims))|\.(ply|obj|off|stl|gltf|glb|bvh|npz))\b",
    re.IGNORECASE,
)
"""Words that only the product says."""
OURS = {"kinetree.tasks", "kinetree.schemas"}
"""Packages that the loom names in one place: their definitions are what a code digest is made of (own_code.py)."""
STUB = "kinetree.schemas.artifact_of_task"
"""A module for type checkers alone, which no program can import."""
TYPES_ALONE = {"pipeline/inspection/typed_by_name.py": ("kinetree.schemas.array", STUB)}
"""Where the loom says the types of the product's artifacts."""
SYNTAX = {"body"}
"""Names of fields of Python's syntax trees."""
PLOTTED = sorted(ROOT.glob("tasks/results/plots/*.py"))
BORDER = ("tasks/input/source.py", "tasks/input/frames/")
DOORS = ("kinetree.pipeline.storage.files", "kinetree.pipeline.identity.key", "kinetree.pipeline.storage.groups")
"""What the border alone may know of the loom."""


@cache
def imports(path: Path) -> frozenset[str]:
    """Every module an import statement of the file names, `from a import b` as a and a.b."""
    modules: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            modules |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            modules |= {str(node.module)} | {f"{node.module}.{alias.name}" for alias in node.names}
    return frozenset(modules)


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def module(path: Path) -> str:
    return "kinetree." + name(path).removesuffix(".py").removesuffix("/__init__").replace("/", ".")


def outside(modules: Iterable[str]) -> set[str]:
    return {m.split(".")[0] for m in modules} - set(sys.stdlib_module_names) - {"kinetree"}


def ours(modules: Iterable[str], *allowed: str) -> set[str]:
    """The kinetree modules among them that lie in none of the allowed packages."""
    mine = {m for m in modules if m.startswith("kinetree.")}
    return {m for m in mine if not any(m == a or m.startswith(a + ".") or a.startswith(m + ".") for a in allowed)}


def shelf(module: str) -> str | None:
    """The shelf of a module of kinetree; None for what lies on none, such as geometry and compiled code."""
    parts = module.split(".")
    for folder in (["kinetree", "tasks", "numerics"], ["kinetree", "tasks"], ["kinetree", "schemas"]):
        if parts[: len(folder)] == folder and len(parts) > len(folder):
            return parts[len(folder)] if parts[len(folder)] in SHELVES else None
    return None


def test_dask_distributed_and_zarr_are_imported_where_they_belong_and_nowhere_else() -> None:
    for library, files in ALONE.items():
        assert {name(path) for path in FILES if library in outside(imports(path))} == files


def test_what_is_slow_to_import_is_imported_where_it_is_used() -> None:
    for path in FILES:
        at_once = ast.parse(path.read_text()).body
        names = {alias.name for node in at_once if isinstance(node, ast.Import) for alias in node.names}
        names |= {str(node.module) for node in at_once if isinstance(node, ast.ImportFrom)}
        assert not names & SLOW, name(path)


def test_numerics_know_numbers_and_nothing_of_the_loom() -> None:
    for path in NUMERICS:
        assert outside(imports(path)) <= NUMERIC | (READERS if shelf(module(path)) == "input" else set()), name(path)
        assert not ours(imports(path), "kinetree.tasks.numerics", "kinetree.errors"), name(path)


def test_schemas_know_only_schemas() -> None:
    for path in SCHEMAS:
        assert outside(imports(path)) <= {"numpy", "pydantic", "pydantic_core"}, name(path)
        assert not ours(imports(path), "kinetree.schemas", "kinetree.errors"), name(path)


def test_tasks_know_their_declaration_and_only_the_source_the_world_outside() -> None:
    for path in OPERATIONS:
        border = DOORS if name(path).startswith(BORDER) else ()
        allowed = ("kinetree.tasks", "kinetree.schemas", "kinetree.pipeline.task", "kinetree.errors", *border)
        assert not ours(imports(path), *allowed), name(path)


def test_the_loom_imports_no_product_and_no_mathematics() -> None:
    for path in sorted(ROOT.glob("pipeline/**/*.py")):
        assert not {m for m in imports(path) if m.startswith(("kinetree.tasks", "kinetree.configs"))}, name(path)
        known = TYPES_ALONE.get(name(path), ("kinetree.schemas.array", "kinetree.schemas.dims"))
        assert not {m for m in imports(path) if m.startswith("kinetree.schemas.") and not m.startswith(known)}, name(path)
        assert not outside(imports(path)) & (NUMERIC - {"numpy", "networkx"}), name(path)
    assert find_spec(STUB) is None


def test_a_room_of_the_loom_imports_only_from_rooms_before_it() -> None:
    assert {path.name for path in ROOT.glob("pipeline/*") if (path / "__init__.py").is_file()} == set(ROOMS)
    for path in sorted(ROOT.glob("pipeline/*/*.py")):
        after = ROOMS[ROOMS.index(path.parent.name) + 1 :]
        assert not {m for m in imports(path) if m.startswith(tuple(f"kinetree.pipeline.{room}" for room in after))}, name(path)


def texts(path: Path) -> list[str]:
    """Every string of the code, parts of f-strings too, without docstrings."""
    tree = ast.parse(path.read_text())
    bare = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    strings = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return [str(node.value) for node in strings if node not in bare]


def test_the_loom_says_no_word_of_the_product() -> None:
    operations = {task.name for graph in METHODS.values() for task in graph.tasks} | set(METHODS)
    for path in sorted(ROOT.glob("pipeline/**/*.py")):
        said = set(texts(path)) - {"own_code.py": OURS, "bindings.py": SYNTAX, "statements.py": SYNTAX}.get(path.name, set())
        assert not {text for text in said if PRODUCT.search(text)}, name(path)
        assert not said & operations, name(path)
        assert not {text for text in said if re.search(rf"\b({'|'.join(operations)})\.[a-z_]+=", text)}


def test_a_shelf_imports_only_from_shelves_to_its_left() -> None:
    for path in [p for p in FILES if shelf(module(p)) is not None]:
        mine = SHELVES.index(str(shelf(module(path))))
        right = {m for m in imports(path) if (other := shelf(m)) is not None and SHELVES.index(other) > mine}
        assert not right, name(path)


def test_geometry_stands_below_all_shelves() -> None:
    for path in sorted(ROOT.glob("tasks/numerics/geometry/*.py")):
        assert not {m for m in imports(path) if shelf(m) is not None}, name(path)


def test_no_module_imports_itself_in_a_ring() -> None:
    graph: nx.DiGraph[str] = nx.DiGraph()
    modules = {module(p): p for p in FILES}
    for here, path in modules.items():
        imported = {m for m in imports(path) if m in modules}
        packages = {m for m in imported if modules[m].name == "__init__.py" and m != "kinetree.errors"}
        graph.add_edges_from((here, m) for m in imported - packages)
    assert list(nx.simple_cycles(graph)) == []


def test_every_operation_has_one_stem_on_one_shelf_behind_every_door() -> None:
    for path in OPERATIONS:
        place = path.parent.name
        assert (ROOT / "schemas" / place / path.name).is_file(), name(path)
        assert (ROOT / "tests" / place / f"test_{path.name}").is_file()
        numeric = [p for p in NUMERICS if path.stem in (p.stem, p.parent.name)]
        assert {shelf(module(p)) for p in numeric} <= {place}, f"numerics of {path.stem} stand on another shelf"


def test_every_schema_has_its_operation() -> None:
    for path in [p for p in SCHEMAS if p.parent.name in SHELVES and p.name != "__init__.py"]:
        shared = {"exports", "figures", "pose"}  # what several operations leave in one form
        assert path.stem in shared or (ROOT / "tasks" / path.parent.name / path.name).is_file(), name(path)


@pytest.mark.parametrize("place", SHELVES)
def test_a_shelf_lists_all_of_its_tasks(place: str) -> None:
    lists = [path for name in LISTS if (path := ROOT / "tasks" / place / name).is_file()]
    listed = {m for path in lists for m in imports(path) if m.startswith(f"kinetree.tasks.{place}.")}
    here = [p for p in OPERATIONS if p.parent.name == place]
    tasks = {module(p) for p in here if re.search(r"^@(task|origin)\(", p.read_text(), re.MULTILINE)}
    assert tasks <= listed, f"tasks/{place} does not list {', '.join(sorted(tasks - listed))}"


def test_every_numeric_file_is_tried_by_laws() -> None:
    tried = {m for test in ROOT.glob("tests/numerics/**/test_*.py") for m in imports(test)}
    for path in NUMERICS:
        assert path.name == "__init__.py" or module(path) in tried, name(path)


def unread(graph: Graph) -> set[str]:
    """Artifacts that no task of the graph reads or goes by, that no plot draws and that leave nothing in the output folder."""
    drawn = {name for path in PLOTTED for name in re.findall(r'fetch\("(\w+)"', path.read_text())}
    read = {a.artifact for task in graph.tasks for a in task.arguments if not issubclass(task.returns, a.artifact)}
    read |= {told for task in graph.tasks for told in (task.along, task.among) if told}
    left = [views.leaves_files, views.group_name, views.page_name]
    stored = {t.returns for t in graph.tasks if t.name not in drawn and not any(leaves(t.returns) for leaves in left)}
    return {artifact.__name__ for artifact in stored if not any(issubclass(artifact, r) for r in read)}


@pytest.mark.parametrize("method", METHODS)
def test_every_artifact_has_a_reader(method: str) -> None:
    assert not unread(METHODS[method])


def test_every_artifact_of_the_graph_over_sequences_has_a_reader() -> None:
    assert not unread(DATA_SETS)


def test_every_method_makes_what_the_summary_of_a_data_set_reads() -> None:
    read = {task.returns for task in DATA_SETS.tasks if task.is_linked}
    for graph in METHODS.values():
        assert {task.returns for task in graph.tasks if not task.over} >= read


def test_artifact_that_nobody_reads_is_named() -> None:
    assert unread(Graph.of(INPUT)) == {"Connectivity"}
    without_report = [task for task in METHODS["mesoscopic"].tasks if task.name not in ("report", "played_body")]
    assert {"StructureFigures", "Verdict"} <= unread(Graph.of(without_report))
