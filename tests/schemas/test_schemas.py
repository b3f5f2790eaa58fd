"""Laws of every schema there is: each field has a sentence, each parameter a default, each dimension one name."""

import importlib
import json
from pathlib import Path
from typing import get_args

import pytest
from pydantic import BaseModel

from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.settings.sentences import sentences
from kinetree.schemas import dims
from kinetree.schemas.array import Artifact, Params
from kinetree.schemas.dims import Dim
from kinetree.schemas.results.comparison import Comparison
from kinetree.schemas.results.skeleton_json import Joint
from kinetree.schemas.results.verdict import Finding, Kind
from kinetree.schemas.structure.error_bars import EvidenceKind
from kinetree.tasks import METHODS
from kinetree.tasks.methods import DATA_SETS

FILES = sorted(p for p in Path(dims.__file__).parent.glob("*/*.py") if p.stem != "__init__")
MODULES = [importlib.import_module(f"kinetree.schemas.{p.parent.name}.{p.stem}") for p in FILES]
MODELS = sorted(
    {m for module in MODULES for m in vars(module).values() if isinstance(m, type) and issubclass(m, BaseModel)}
    - {Artifact, Params},
    key=lambda m: m.__name__,
)
ARTIFACTS = [m for m in MODELS if issubclass(m, Artifact) and not m.__subclasses__()]
ANSWERS = {Comparison}
"""What functions of `tasks/` return and no task writes."""
SETTINGS = [m for m in MODELS if issubclass(m, Params)]
TASKS = {task.name: task for graph in (DATA_SETS, *METHODS.values()) for task in graph.tasks}
UNITS = {"1", "length", "length²", "length³", "°", "radian"}
"""What arrays are measured in, each written in one way."""
DIMS = {dim.name: dim for dim in vars(dims).values() if isinstance(dim, Dim)}


def named(model):
    return model.__name__


def test_there_are_schemas():
    assert {"Mesh", "Source", "Sequence", "Connectivity"} <= {m.__name__ for m in ARTIFACTS}


@pytest.mark.parametrize("model", MODELS, ids=named)
def test_every_field_and_schema_has_a_sentence(model):
    for name, sentence in [(model.__name__, model.__doc__), *((n, sentences(model).get(n)) for n in model.model_fields)]:
        assert sentence, f"{model.__name__}.{name} has no docstring"
        assert sentence.strip().endswith("."), f"{model.__name__}.{name}: {sentence!r} is no sentence"


@pytest.mark.parametrize("model", [t.params for t in TASKS.values() if t.params], ids=named)
def test_every_parameter_of_a_task_has_a_default_that_is_valid(model):
    params = model()
    assert model.model_validate(params.model_dump(mode="json")) == params
    json.dumps(params.model_dump(mode="json"), allow_nan=False)


@pytest.mark.parametrize("model", SETTINGS, ids=named)
def test_unknown_parameters_are_refused(model):
    with pytest.raises(ValueError, match="Extra inputs are not permitted"):
        model.model_validate({"no_such_parameter_anywhere": 1})


@pytest.mark.parametrize("model", ARTIFACTS, ids=named)
def test_every_array_has_dimensions_of_the_one_list_and_a_unit(model):
    for name, spec in model.array_fields().items():
        assert spec.unit in UNITS, f"{model.__name__}.{name}: {spec.unit!r} is none of the units {', '.join(sorted(UNITS))}"
        for dim in spec.dims:
            assert DIMS[dim.name] is dim, f"{model.__name__}.{name}: {dim.name} is not the one of dims.py"
        assert len({d.name for d in spec.dims}) == len(spec.dims), f"{model.__name__}.{name} has one dimension twice"


@pytest.mark.parametrize("model", ARTIFACTS, ids=named)
def test_every_other_field_is_plain_json(model):
    schema = model.model_json_schema if not model.array_fields() else None
    if schema is not None:
        assert json.dumps(schema())
    for name in model.location_fields():
        assert name not in model.array_fields()


@pytest.mark.parametrize("name", TASKS)
def test_task_artifact_and_params_share_one_stem(name):
    task = TASKS[name]
    artifact = task.returns.__name__
    place, _, stem = task.module.removeprefix("kinetree.tasks.").partition(".")
    assert name == stem or name.endswith(f"_{stem}"), "a later pass of an operation is named first_refit, second_refit, …"
    default = METHODS["mesoscopic"]
    ways = {graph.writers[task.returns].name for graph in METHODS.values() if task.returns in graph.writers} - {name}
    is_another = any(task.returns.__module__.endswith(f".{way}") for way in ways)
    if not (name not in default.by_name and is_another):  # another method's way to the same artifact has a name of its own
        assert artifact.lower() == name.replace("_", "")
        assert task.returns.__module__ == f"kinetree.schemas.{place}.{stem}"
    if task.params is not None:
        owner = TASKS[task.block]  # the task itself, or another whose block sets both
        assert issubclass(owner.sets, task.params)
    if task.sets is not None:
        assert task.sets.__name__.lower() == f"{task.name.replace('_', '')}params"
        assert task.sets.__module__ == f"kinetree.schemas.{place}.{stem}"


@pytest.mark.parametrize("model", ARTIFACTS, ids=named)
def test_every_schema_is_written_by_a_task_is_what_several_have_in_common_or_answers_a_command(model):
    assert model in ANSWERS or any(issubclass(task.returns, model) for task in TASKS.values())


def test_version_is_a_number_from_one_on():
    for model in ARTIFACTS:
        assert isinstance(model.version, int)
        assert model.version >= 1


def test_dimensions_have_one_name_each():
    names = [dim.name for dim in vars(dims).values() if isinstance(dim, Dim)]
    assert len(names) == len(set(names))
    assert all(constant == dim.name.upper() for constant, dim in vars(dims).items() if isinstance(dim, Dim))


def test_defaults_make_a_configuration():
    for method, graph in METHODS.items():
        params = Pipeline.of({"method": method}).config.params
        assert set(params) == {task.block for task in graph.tasks if task.params or task.sets}


@pytest.mark.parametrize(
    ("model", "field", "words"),
    [(Finding, "kind", get_args(Kind)), (Joint, "evidence", get_args(EvidenceKind))],
    ids=["finding", "evidence"],
)
def test_what_a_kind_means_is_said_of_each(model, field, words):
    sentence = sentences(model)[field]
    assert [word for word in words if f"{word} " not in sentence and f"{word}:" not in sentence] == []
