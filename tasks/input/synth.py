"""Synthetic sequences with a true skeleton, generated frame by frame where a captured one would be read."""

import importlib.resources
import json
import os
import reprlib
import shutil
from dataclasses import fields
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np
import trimesh

from kinetree.errors import ConfigError, FigureError
from kinetree.errors.small_text import json_only, small_text, small_yaml
from kinetree.schemas.input.synth import SynthParams
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure, named
from kinetree.tasks.numerics.input.synth.paint import Paint
from kinetree.tasks.numerics.input.synth.people import person
from kinetree.tasks.numerics.input.synth.trees import random_tree

FIGURES = importlib.resources.files("kinetree.configs") / "figures"
PEOPLE = importlib.resources.files("kinetree.configs") / "people"
LARGEST = 4 * 2**20
"""Bytes of a figure's file that is read."""
_PAINTED = ("paint", "illumination", "grain")
"""What a recipe says of colours."""


def recipe(params: SynthParams) -> str:
    """All that decides the sequence, as JSON with the figure written out: equal recipes, equal bytes, on any machine.

    raises : FigureError where the figure, the motion or a limb is not known, or a clothed figure would be painted
    """
    unpainted = params.paint == "none"  # the recipe of a body without colours says nothing of them
    options = params.model_dump(mode="json", exclude={"figure", "file", "clothes", *(_PAINTED if unpainted else ())})
    written = json.dumps({"figure": _description(params), **options}, sort_keys=True)
    if body(written).figure.clothes and not unpainted:
        raise FigureError("paint colours the skin, which loose clothes cover and slide over; ask for paint or for clothes")
    return written


@lru_cache(maxsize=4)
def body(written: str) -> Body:
    """The body that a recipe describes, posed in every frame and not surfaced yet."""
    options: dict[str, Any] = {k: v for k, v in json.loads(written).items() if k not in _PAINTED}
    figure = options.pop("figure")
    tree = random_tree(figure["random"]) if "random" in figure else Figure.of(figure)
    return Body.of(tree, **options)


@lru_cache(maxsize=4)
def paint(written: str) -> Paint | None:
    """The colours of the body that a recipe describes; None where it is not painted."""
    recipe: dict[str, Any] = json.loads(written)
    if "paint" not in recipe:
        return None
    skinned = body(json.dumps({**recipe, "connectivity": "fixed", "noise": 0.0, "holes": 0, "dropped": []}, sort_keys=True))
    return Paint(body(written), skinned, recipe["paint"], recipe["illumination"], recipe["grain"])


def write_sequence(params: SynthParams, folder: Path, *, volumes: bool = False, cameras: int = 0) -> None:
    """Writes a sequence as a person would have it: one PLY a frame, and truth.json beside them.

    volumes : also volume_0000.npz …: signed distance on a grid, negative inside, with origin and voxel
    cameras : also silhouettes_0000.npz …, from a ring of so many cameras, and cameras.npz with their 3×4 matrices
    raises  : FigureError where the figure is not known; ConfigError where the folder holds something already
    """
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise ConfigError(f"{folder}: not an empty folder; name a new one, so that no frame of another sequence stays in it")
    written = recipe(params)
    generated = body(written)
    beside = folder.absolute().with_name(f".{folder.name}.{os.getpid()}")
    try:
        beside.mkdir(parents=True)
        _write_frames(generated, paint(written), beside, volumes, cameras)
        (beside / "truth.json").write_text(json.dumps(generated.truth()))
        if folder.is_dir():
            folder.rmdir()
        beside.rename(folder)
    except OSError as error:
        raise ConfigError(f"{folder}: cannot be written: {error.strerror}") from error
    finally:
        shutil.rmtree(beside, ignore_errors=True)


def _write_frames(generated: Body, colours: Paint | None, folder: Path, volumes: bool, cameras: int) -> None:
    """Writes every frame, with volumes and silhouettes where wanted."""
    ring = generated.cameras(cameras) if cameras else None
    if ring is not None:
        np.savez_compressed(folder / "cameras.npz", **{f.name: getattr(ring, f.name) for f in fields(ring)})
    for t in range(len(generated.X)):
        V, F = generated.frame(t)
        vertex_colours = None if colours is None else np.round(255.0 * colours.colours(t, V, F)).astype(np.uint8)
        ply = trimesh.Trimesh(V, F, vertex_colors=vertex_colours, process=False).export(file_type="ply", vertex_normal=False)
        (folder / f"frame_{t:04d}.ply").write_bytes(ply)
        if volumes:
            np.savez_compressed(folder / f"volume_{t:04d}.npz", **generated.volume(t)._asdict())
        if ring is not None:
            np.savez_compressed(folder / f"silhouettes_{t:04d}.npz", silhouettes=generated.silhouettes(t, ring))


def figure_names() -> list[str]:
    """The figures that ship with kinetree."""
    return sorted(f.name.removesuffix(".yaml") for f in FIGURES.iterdir() if f.name.endswith(".yaml"))


def _description(params: SynthParams) -> dict[str, Any]:
    """The figure as data."""
    if params.file and not params.clothes:
        return _read(Path(params.file))
    kind, colon, seed = params.figure.partition(":")
    if params.clothes and not (kind == "adult" and colon):
        raise FigureError(f"clothes: figure {reprlib.repr(params.figure)} has none; they are for adult:SEED, e.g. adult:7")
    if kind in ("random", "adult") and colon:
        if not (seed.isascii() and seed.isdigit() and len(seed) <= 18):
            what = f"figure {reprlib.repr(params.figure)}"
            raise FigureError(f"{what}: write {kind}:SEED with a whole number of at most 18 digits, e.g. {kind}:7")
        return {"random": int(seed)} if kind == "random" else _person(int(seed), params.motion, params.clothes)
    known = {name: _read(FIGURES / f"{name}.yaml") for name in figure_names()}
    named(params.figure, known)
    return known[params.figure]


@lru_cache(maxsize=4)
def _person(seed: int, motion: str | None, clothed: bool) -> dict[str, Any]:
    """A person drawn from a seed, with one motion."""
    return person(_read(PEOPLE / "adult.yaml"), motion, seed, clothed)


def _read(path: Any) -> dict[str, Any]:
    """A figure's description from a YAML file."""
    description = json_only(small_yaml(small_text(path, FigureError, LARGEST), str(path), FigureError), str(path), FigureError)
    if not isinstance(description, dict):
        raise FigureError(f"{path}: expected a figure with its joints, got {type(description).__name__}")
    return description
