"""Synthetic sequences with a true skeleton, generated frame by frame where a captured one would be read."""

import importlib.resources
import json
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from kinetree.pipeline.errors import ConfigError
from kinetree.schemas.synth import SynthParams
from kinetree.tasks.numerics.figures import Figure, named
from kinetree.tasks.numerics.synth import Body
from kinetree.tasks.numerics.trees import random_tree

FIGURES = importlib.resources.files("kinetree.configs") / "figures"


def recipe(params: SynthParams) -> str:
    """All that decides the sequence, as JSON with the figure written out: equal recipes, equal bytes, on any machine.

    raises : ConfigError where the figure, the motion or a limb is not known
    """
    told = params.model_dump(mode="json", exclude={"figure", "file"})
    written = json.dumps({"figure": _description(params), **told}, sort_keys=True)
    body(written)
    return written


@lru_cache(maxsize=4)
def body(written: str) -> Body:
    """The body that a recipe describes, posed in every frame and not surfaced yet."""
    options: dict[str, Any] = json.loads(written)
    figure = options.pop("figure")
    made = random_tree(figure["random"]) if "random" in figure else Figure.of(figure)
    return Body.of(made, **options)


def figure_names() -> list[str]:
    """The figures that ship with kinetree."""
    return sorted(f.name.removesuffix(".yaml") for f in FIGURES.iterdir() if f.name.endswith(".yaml"))


def _description(params: SynthParams) -> dict[str, Any]:
    """The figure as data."""
    if params.file:
        return _read(Path(params.file))
    kind, colon, seed = params.figure.partition(":")
    if kind == "random" and colon:
        if not seed.isdigit():
            raise ConfigError(f"figure {params.figure!r}: write random:SEED with a whole number, e.g. random:7")
        return {"random": int(seed)}
    known = {name: _read(FIGURES / f"{name}.yaml") for name in figure_names()}
    named(params.figure, known)
    return known[params.figure]


def _read(path: Any) -> dict[str, Any]:
    try:
        told = yaml.safe_load(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError) as error:
        raise ConfigError(f"{path}: cannot be read: {error}") from None
    except yaml.YAMLError as error:
        raise ConfigError(f"{path}: not valid YAML: {error}") from None
    if not isinstance(told, dict):
        raise ConfigError(f"{path}: expected a figure with its joints, got {type(told).__name__}")
    return told
