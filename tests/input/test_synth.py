"""Synthetic sequences, as source, command and file."""

import json
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest
import trimesh

from kinetree.errors import ConfigError, FigureError, SourceError
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.source import SourceParams
from kinetree.schemas.input.synth import ContactParams, SynthParams
from kinetree.tasks.commands.synth import synth
from kinetree.tasks.input.frames.read import surface
from kinetree.tasks.input.source import source
from kinetree.tasks.input.synth import body, figure_names, recipe, write_sequence

SMALL = SynthParams(frames=3, vertices=600)


def listed(tmp_path: Path, **params: object) -> dict[int, object]:
    return dict(source(params=SourceParams(**params), files=Files.of(Store.at(tmp_path / "store"))))  # type: ignore[arg-type]


def test_same_words_are_the_same_recipe_and_other_words_another() -> None:
    assert recipe(SMALL) == recipe(SynthParams(frames=3, vertices=600))
    assert recipe(SMALL) != recipe(SynthParams(frames=3, vertices=600, seed=1))


def test_figure_that_does_not_exist_is_refused_with_the_nearest() -> None:
    with pytest.raises(FigureError, match="human"):
        recipe(SynthParams(figure="humn"))
    for seed in ("x", "²", "-1"):
        for kind in ("random", "adult"):
            with pytest.raises(FigureError, match=f"{kind}:SEED"):
                recipe(SynthParams(figure=f"{kind}:{seed}"))


def test_clothes_are_for_people_and_leave_other_recipes_as_they_are() -> None:
    bare, clothed = (json.loads(recipe(SynthParams(figure="adult:3", frames=2, clothes=c))) for c in (False, True))
    assert clothed["figure"].pop("clothes")
    assert bare == clothed
    for figure in ("human", "adult", "random:3"):
        with pytest.raises(FigureError, match="they are for adult:SEED"):
            recipe(SynthParams(figure=figure, clothes=True))
    with pytest.raises(FigureError, match="ask for paint or for clothes"):
        recipe(SynthParams(figure="adult:3", frames=2, clothes=True, paint="plain"))


def test_limb_that_does_not_exist_is_refused_before_anything_runs() -> None:
    with pytest.raises(FigureError, match="hand_r"):
        recipe(SynthParams(contacts=(ContactParams(limb="hnd_r", target="hip_r", begin=1, end=2),)))


def test_source_lists_frames_whose_content_follows_the_recipe(tmp_path: Path) -> None:
    here, again, other = (listed(tmp_path, synth=s) for s in (SMALL, SMALL, SynthParams(frames=3, vertices=600, seed=1)))
    assert here == again
    assert list(here) == [0, 1, 2]
    assert not {s.content for s in here.values()} & {s.content for s in other.values()}
    V, F = surface(here[1])
    expected = body(recipe(SMALL)).frame(1)
    assert np.array_equal(V, expected[0])
    assert np.array_equal(F, expected[1])


def test_input_and_synth_exclude_each_other(tmp_path: Path) -> None:
    with pytest.raises(SourceError, match="exclude each other"):
        listed(tmp_path, input="scans", synth=SMALL)


def test_written_sequence_holds_the_frames_and_their_truth(tmp_path: Path) -> None:
    write_sequence(SMALL, tmp_path / "walk", volumes=True, cameras=2)
    truth = json.loads((tmp_path / "walk" / "truth.json").read_text())
    assert len(truth["positions"]) == 3
    assert {"joints", "positions", "height", "unit"} <= set(truth)
    for t in range(3):
        read = trimesh.load_mesh(tmp_path / "walk" / f"frame_{t:04d}.ply", process=False)
        V, F = body(recipe(SMALL)).frame(t)
        assert np.allclose(read.vertices, V, atol=1e-3)
        assert np.array_equal(read.faces, F)
        assert np.load(tmp_path / "walk" / f"volume_{t:04d}.npz")["field"].min() < 0
        assert np.load(tmp_path / "walk" / f"silhouettes_{t:04d}.npz")["silhouettes"].any(axis=(1, 2)).all()


def test_folder_that_holds_something_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ConfigError, match="not an empty folder"):
        write_sequence(SMALL, tmp_path)
    assert [p.name for p in tmp_path.iterdir()] == ["mine.txt"]


def test_options_that_cannot_be_are_refused_in_one_line_each(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"^synth\.noise: input should be greater than or equal to 0, got -1\.0$"):
        synth(noise=-1.0, output=tmp_path / "new")
    with pytest.raises(FigureError, match=r"nowhere\.yaml: cannot be read: No such file or directory$"):
        synth(figure="nowhere.yaml", output=tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_example_in_the_refusal_of_a_dropped_limb_is_one(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"write LIMB:BEGIN:END, e\.g\. ") as refused:
        synth(drop=["hand"], output=tmp_path / "new")
    example = str(refused.value).split("e.g. ")[1].replace(":12:26", ":0:1")
    synth(frames=2, vertices=300, drop=[example], output=tmp_path / "new")
    assert json.loads((tmp_path / "new" / "truth.json").read_text())["dropped"]


def test_figure_of_ones_own_is_read_from_yaml(tmp_path: Path) -> None:
    own = tmp_path / "gripper.yaml"
    own.write_text(
        "name: gripper\nunit: m\njoints:\n"
        "  - {name: palm, position: [0, 0, 0], radius: 0.06}\n"
        "  - {name: knuckle, parent: palm, position: [0, 0, 0.15], radius: 0.03}\n"
        "  - {name: tip, parent: knuckle, position: [0, 0, 0.3], radius: 0.02}\n"
        "motions:\n  nod:\n    knuckle: [{axis: [1, 0, 0], amplitude: 30, frequency: 1}]\n"
    )
    made = body(recipe(SynthParams(figure="", file=str(own), frames=2, vertices=300)))
    assert made.figure.names == ["palm", "knuckle", "tip"]
    own.write_text("a: [")
    with pytest.raises(FigureError, match="not valid YAML"):
        recipe(SynthParams(file=str(own)))


def test_help_of_the_command_names_every_figure() -> None:
    declared = get_type_hints(synth, include_extras=True)["figure"].__metadata__[0].help
    assert declared.startswith(f"{', '.join(figure_names())}, adult:SEED, random:SEED")


def test_painted_sequence_has_colours_in_its_files(tmp_path: Path) -> None:
    painted = SMALL.model_copy(update={"paint": "patterned"})
    write_sequence(painted, tmp_path / "walk")
    read = trimesh.load_mesh(tmp_path / "walk" / "frame_0001.ply", process=False)
    V, _ = body(recipe(SMALL)).frame(1)
    assert np.allclose(read.vertices, V, atol=1e-3)  # paint moves nothing
    assert np.ptp(read.visual.vertex_colors[:, :3], axis=0).min() > 50
