"""Who may import whom, and that every operation has one stem behind every door."""

import ast
import re
import sys
from pathlib import Path

import networkx as nx
import pytest

from kinetree.tasks import METHODS

ROOT = Path(__file__).resolve().parent.parent
FILES = [*ROOT.glob("pipeline/*.py"), *ROOT.glob("schemas/*.py"), *ROOT.glob("tasks/**/*.py")]
NUMERIC = {"numpy", "scipy", "numba", "networkx", "trimesh", "skimage"}
ALONE = {"dask": "pipeline/run.py", "distributed": "pipeline/clusters.py", "zarr": "pipeline/store.py"}
TABLES = ("__init__.py", "methods.py", "application.py")
"""Files of the tasks that hold no operation: what there is and how it is offered."""
OPERATIONS = [p for p in ROOT.glob("tasks/*.py") if p.name not in TABLES]
PRODUCT = re.compile(
    r"\b(mesh|meshes|skeletons?|joints?|bones?|body|bodies|limbs?|scans?|vertex|vertices|geodesics?|kinematic|silhouettes?"
    r"|kinetree\.(tasks|configs|schemas\.(?!array|dims))|\.(ply|obj|off|stl|gltf|glb|bvh|npz))\b",
    re.IGNORECASE,
)
"""Words that only the product says."""
OURS = {"kinetree.tasks", "kinetree.schemas"}
"""Packages that the loom names in one place: their definitions are what a code digest is made of (key.py)."""
BORDER = "tasks/source.py"


def imports(path: Path) -> set[str]:
    """Every module an import statement of the file names, `from a import b` as a and a.b."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path}: relative import"
            found |= {str(node.module)} | {f"{node.module}.{alias.name}" for alias in node.names}
    return found


def name(path: Path) -> str:
    return str(path.relative_to(ROOT))


def outside(modules: set[str]) -> set[str]:
    return {m.split(".")[0] for m in modules} - set(sys.stdlib_module_names) - {"kinetree"}


def ours(modules: set[str], *allowed: str) -> set[str]:
    """The kinetree modules among them that lie in none of the allowed packages."""
    mine = {m for m in modules if m.startswith("kinetree.")}
    return {m for m in mine if not any(m == a or m.startswith(a + ".") or a.startswith(m + ".") for a in allowed)}


@pytest.mark.parametrize("path", FILES, ids=name)
def test_one_file_each_imports_dask_distributed_and_zarr(path: Path) -> None:
    for library, home in ALONE.items():
        if name(path) != home:
            assert library not in outside(imports(path))


@pytest.mark.parametrize("path", list(ROOT.glob("tasks/numerics/**/*.py")), ids=name)
def test_numerics_know_numbers_and_nothing_of_the_loom(path: Path) -> None:
    assert outside(imports(path)) <= NUMERIC
    assert not ours(imports(path), "kinetree.tasks.numerics", "kinetree.errors")


@pytest.mark.parametrize("path", list(ROOT.glob("schemas/*.py")), ids=name)
def test_schemas_know_only_schemas(path: Path) -> None:
    assert outside(imports(path)) <= {"numpy", "pydantic", "pydantic_core"}
    assert not ours(imports(path), "kinetree.schemas", "kinetree.errors")


@pytest.mark.parametrize("path", OPERATIONS, ids=name)
def test_tasks_know_their_declaration_and_only_the_source_the_world_outside(path: Path) -> None:
    border = ["kinetree.pipeline.files", "kinetree.pipeline.key", "kinetree.pipeline.store"] if name(path) == BORDER else []
    allowed = ["kinetree.tasks", "kinetree.schemas", "kinetree.pipeline.task", "kinetree.errors", *border]
    assert not ours(imports(path), *allowed)


@pytest.mark.parametrize("path", list(ROOT.glob("pipeline/*.py")), ids=name)
def test_the_loom_imports_no_product_and_no_mathematics(path: Path) -> None:
    assert not {m for m in imports(path) if m.startswith(("kinetree.tasks", "kinetree.configs"))}
    assert not {m for m in imports(path) if m.startswith("kinetree.schemas.")} - {
        m for m in imports(path) if m.startswith(("kinetree.schemas.array", "kinetree.schemas.dims"))
    }
    assert not outside(imports(path)) & (NUMERIC - {"numpy", "networkx"})


def texts(path: Path) -> list[str]:
    """Every string of the code, parts of f-strings too, without docstrings."""
    tree = ast.parse(path.read_text())
    bare = {node.value for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    strings = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and isinstance(node.value, str)]
    return [str(node.value) for node in strings if node not in bare]


@pytest.mark.parametrize("path", list(ROOT.glob("pipeline/*.py")), ids=name)
def test_the_loom_says_no_word_of_the_product(path: Path) -> None:
    operations = {task.name for graph in METHODS.values() for task in graph.tasks} | set(METHODS)
    said = set(texts(path)) - (OURS if path.name == "key.py" else set())
    assert not {text for text in said if PRODUCT.search(text)}
    assert not said & operations
    assert not {text for text in said if re.search(rf"\b({'|'.join(operations)})\.[a-z_]+=", text)}


def test_no_module_imports_itself_in_a_ring() -> None:
    graph: nx.DiGraph[str] = nx.DiGraph()
    modules = {"kinetree." + name(p).removesuffix(".py").removesuffix("/__init__").replace("/", "."): p for p in FILES}
    for module, path in modules.items():
        seen = {m for m in imports(path) if m in modules}
        packages = {m for m in seen if modules[m].name == "__init__.py"}
        graph.add_edges_from((module, m) for m in seen - packages)
    assert list(nx.simple_cycles(graph)) == []


@pytest.mark.parametrize("path", OPERATIONS, ids=name)
def test_every_operation_has_one_stem_behind_every_door(path: Path) -> None:
    assert (ROOT / "schemas" / path.name).is_file()
    assert (ROOT / "tests" / "tasks" / f"test_{path.name}").is_file()


def test_every_numeric_file_is_tried_by_laws() -> None:
    tried = {m for test in ROOT.glob("tests/numerics/**/test_*.py") for m in imports(test)}
    for path in ROOT.glob("tasks/numerics/**/*.py"):
        stem = "kinetree." + name(path).removesuffix(".py").replace("/", ".")
        assert path.name == "__init__.py" or stem in tried, f"no law imports {stem}"
