"""Exports through the loom: what a run leaves, what changing an option computes, and what kinetree export says."""

import errno
import json
import os
import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
import zarr
from results.export_graph import GRAPH, order, write_frames
from results.gltf_reader import Glb as Read
from results.rigged_bodies import spider
from zips import alter

from kinetree.errors import (
    ConfigError,
    DamagedArtifactError,
    InputError,
    NodesFailedError,
    StoreError,
    StoreFullError,
    UnknownNodeError,
)
from kinetree.pipeline import application, views
from kinetree.pipeline.command_line import commands
from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.output.output import write_elsewhere
from kinetree.pipeline.output.ownership import MARKER
from kinetree.pipeline.storage.place import Folder
from kinetree.pipeline.storage.store import artifact_path
from kinetree.schemas.results.bvh import Bvh
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.export import EXTRAS, export

EXPORTING = replace(APPLICATION, methods=lambda: {"mesoscopic": GRAPH})
"""kinetree with the exports alone."""

LEFT = ["segmentation.zarr", "skeleton.bvh", "skeleton.glb", "skeleton.json"]


@pytest.fixture(scope="module")
def scans(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scans")
    write_frames(folder)
    return folder


@pytest.fixture(scope="module")
def computed(scans, tmp_path_factory):
    """The store of a run that is done, of which every test has a copy."""
    folder = tmp_path_factory.mktemp("computed")
    result = {"source": {"input": str(scans)}, "output": str(folder), "compute": {"executor": "sync"}}
    assert Pipeline.of(result, methods={"mesoscopic": GRAPH}).run()["status"] == "done"
    return folder / "store"


@pytest.fixture
def configured(scans, computed, tmp_path, monkeypatch):
    shutil.copytree(computed, tmp_path / "out" / "store")
    monkeypatch.setattr(application, "_installed", lambda: EXPORTING)
    return {"source": {"input": str(scans)}, "output": str(tmp_path / "out"), "compute": {"executor": "sync"}}


@pytest.fixture
def out(configured, tmp_path):
    """The folder of a run that is done."""
    result = Pipeline.of(configured).run()
    assert result["status"] == "done", result
    assert sorted(result["files"]) == LEFT
    return tmp_path / "out"


def names(folder):
    return sorted(p.name for p in folder.iterdir() if p.name != MARKER)


def ran(result):
    return {task for task, row in result["tasks"].items() if row["ran"]}


def test_run_leaves_what_people_take_away_and_says_so(out):
    assert names(out) == sorted([*LEFT, "config.yaml", "run.json", "store"])
    assert json.loads((out / "run.json").read_text())["files"]
    assert json.loads((out / "skeleton.json").read_text())["joints"][0]["name"] == "trunk"


def test_second_run_computes_nothing_and_touches_no_file(out, configured):
    before = {name: (out / name).stat().st_mtime_ns for name in LEFT}
    result = Pipeline.of(configured).run()
    assert ran(result) == set()
    assert {name: (out / name).stat().st_mtime_ns for name in LEFT} == before


def test_file_that_was_deleted_or_altered_is_left_again_without_computing(out, configured):
    before = (out / "skeleton.glb").read_bytes()
    (out / "skeleton.glb").write_bytes(before[:-1] + b"x")
    (out / "skeleton.bvh").unlink()
    (out / "segmentation.zarr" / "label" / "zarr.json").unlink()
    assert ran(Pipeline.of(configured).run()) == set()
    assert (out / "skeleton.glb").read_bytes() == before
    assert (out / "skeleton.bvh").is_file()
    assert (out / "segmentation.zarr" / "label" / "zarr.json").is_file()


def test_copy_of_a_run_is_exported_where_it_lies_when_the_original_is_gone(out, tmp_path):
    there = shutil.copytree(out, tmp_path / "colleague" / "out")
    shutil.rmtree(out)
    (there / "skeleton.glb").unlink()
    pipeline = Pipeline.of(there)
    assert pipeline.plan().is_done
    assert pipeline.artifact("skeleton_json").content.size
    export(str(there))
    assert (there / "skeleton.glb").is_file()
    assert not out.exists()


def test_one_byte_altered_in_a_group_that_was_left_is_restored_without_computing(out, configured):
    group = out / "segmentation.zarr"
    before = {path: path.read_bytes() for path in group.rglob("*") if path.is_file()}
    for path, data in before.items():
        middle = len(data) // 2
        path.write_bytes(data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :])
    assert ran(Pipeline.of(configured).run()) == set()
    assert {path: path.read_bytes() for path in group.rglob("*") if path.is_file()} == before


def test_files_stand_upright_and_in_their_unit(out):
    body, to = spider(), np.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])
    file = Read((out / "skeleton.glb").read_bytes())
    np.testing.assert_allclose(file.pose(3)[:, :3, 3], body.positions[3] @ to / 1000, atol=1e-7)
    first = (out / "skeleton.bvh").read_text().splitlines()[-12].split()
    np.testing.assert_allclose(list(map(float, first[:3])), body.positions[0, 0] @ to / 10, atol=1e-6)


def test_names_that_people_know_are_those_of_all_files_and_the_skeleton_keeps_its_own(out, configured):
    pipeline = Pipeline.of(configured, sets=["joint_names.rename={arm: jaw}"])
    assert ran(pipeline.run(until=["glb", "bvh", "skeleton_json", "tables"])) == {
        "joint_names", "assumed_joints", "glb", "bvh", "skeleton_json", "tables",
    }  # fmt: skip
    assert "jaw" in Read((out / "skeleton.glb").read_bytes()).names
    assert "JOINT jaw" in (out / "skeleton.bvh").read_text()
    assert json.loads((out / "skeleton.json").read_text())["joints"][1]["name"] == "jaw"
    assert ",jaw," in (out / "tables" / "motion.csv").read_text()
    assert pipeline.artifact("skeleton").names == spider().names


def test_export_takes_other_names_without_a_run(out, configured, tmp_path):
    (tmp_path / "walk.yaml").write_text(json.dumps(configured))
    export(str(tmp_path / "walk.yaml"), "bvh", tmp_path / "named.bvh", sets=["joint_names.rename={arm: jaw}"])
    assert "JOINT jaw" in (tmp_path / "named.bvh").read_text()
    export(str(tmp_path / "walk.yaml"), "blender", tmp_path / "named", sets=["glb.surface=parts", "glb.scale=2"])
    assert np.ptp(Read((tmp_path / "named" / "skeleton.glb").read_bytes()).attribute("POSITION")) > 1.0
    assert "JOINT arm" in (out / "skeleton.bvh").read_text()


def test_option_of_an_export_runs_that_export_alone(out, configured):
    before = {name: (out / name).read_bytes() for name in LEFT[1:]}
    result = Pipeline.of(configured, sets=["glb.up=y"]).run()
    assert ran(result) == {"glb"}
    changed = {name for name in before if (out / name).read_bytes() != before[name]}
    assert changed == {"skeleton.glb"}


def test_exports_on_request_are_in_the_graph_and_run_when_they_are_named(out, configured):
    pipeline = Pipeline.of(configured)
    assert pipeline.plan().is_done
    assert {"usd", "ply", "tables", "rignet"} & {row.task for row in pipeline.plan().tasks} == set()
    assert pipeline.why("rignet").state == "stale"
    assert ran(pipeline.run(until=["rignet"])) == {"rignet"}
    assert names(out / "rignet") == ["skeleton.obj", "skeleton.txt"]


def test_exports_on_request_count_in_an_estimate_where_a_run_would_compute_them(out, configured):
    pipeline = Pipeline.of(out)
    expected = pipeline.inspect().estimate()
    assert (expected.nodes, expected.seconds, expected.unknown) == (0, 0, ())
    named = pipeline.inspect(until=["rignet"]).estimate()
    assert (named.nodes, named.unknown) == (1, ("rignet",))
    assert pipeline.inspect(force=["bvh", "rignet"]).estimate().nodes == 1
    never = Pipeline.of({**configured, "output": f"{out}-2"})
    estimates = [never.inspect(until=until).estimate() for until in ((), never.tasks.unasked)]
    assert estimates[0] == estimates[1]
    assert estimates[0].nodes


def test_damaged_export_on_request_is_dropped_and_computed_when_it_is_named_again(out, configured):
    verified = command_line(EXPORTING)
    assert ran(Pipeline.of(configured).run(until=["rignet"])) == {"rignet"}
    alter(out / "store" / artifact_path(Pipeline.of(out).why("rignet").artifact), "content/c/0", lambda data: bytes(len(data)))
    assert verified(["verify", str(out)], standalone_mode=False) == 1
    assert not verified(["verify", str(out), "--repair"], standalone_mode=False)
    assert not verified(["verify", str(out)], standalone_mode=False)
    assert ran(Pipeline.of(configured).run(until=["rignet"])) == {"rignet"}


def test_repair_after_which_something_is_missing_ends_with_1(out, monkeypatch, capsys):
    artifact = {task: out / "store" / artifact_path(Pipeline.of(out).why(task).artifact) for task in ("bvh", "glb")}
    artifact["bvh"].unlink()
    monkeypatch.setattr(commands, "compute_and_report", lambda *_, **__: artifact["glb"].unlink())
    assert command_line(EXPORTING)(["verify", str(out), "--repair"], standalone_mode=False) == 1
    assert f"{artifact_path(artifact['glb'].stem)}: it is missing" in capsys.readouterr().err


def test_failed_skeleton_leaves_no_file(configured, tmp_path):
    result = Pipeline.of({**configured, "skeleton": {"fails": True}}).run()
    assert result["status"] == "failed"
    assert result["files"] == []
    assert names(tmp_path / "out") == ["config.yaml", "run.json", "store"]


@pytest.mark.parametrize(("task", "array", "expected"), [("bvh", "content", "skeleton.bvh"), ("segmentation", "part", LEFT[0])])
def test_damaged_export_is_made_again_by_the_next_run(out, configured, task, array, expected):
    pipeline = Pipeline.of(configured)
    node = pipeline.why(task)
    alter(out / "store" / artifact_path(node.artifact), f"{array}/c/0", lambda data: bytes(len(data)))
    shutil.rmtree(out / expected) if (out / expected).is_dir() else (out / expected).unlink()
    with pytest.raises(DamagedArtifactError, match="will be computed again"):
        pipeline.run()
    assert expected not in names(out)
    assert ran(Pipeline.of(configured).run()) == {task}
    assert expected in names(out)


def republished(out, name):
    """The store has another artifact for the task `bvh`, whose only file has this name."""
    pipeline = Pipeline.of(out)
    store, node = pipeline.store, pipeline.why("bvh")
    bvh = store.read(Bvh, str(node.artifact))
    digest, size = store.publish(bvh.model_copy(update={"names": (name,)}))
    store.write(replace(store.record(str(node.key)), artifact=digest, bytes=size))
    return store, digest


@pytest.mark.parametrize(
    "name", ["{above}/elsewhere.sh", "x/../../elsewhere.sh", "..", "", "a//b", "a/", "./a", "a\\b", "a\0b", "\ud800"]
)
def test_file_of_a_store_from_elsewhere_that_does_not_lie_in_the_output_folder_is_damage(out, configured, tmp_path, name):
    store, digest = republished(out, name.format(above=tmp_path))
    (out / MARKER).write_text(json.dumps({"files": ["", "..", "x", "a", "config.yaml", "run.json", *LEFT]}))
    before = names(tmp_path)
    with pytest.raises(DamagedArtifactError, match="its values are not those of its schema"):
        store.check(digest, {"Bvh": Bvh})
    with pytest.raises(DamagedArtifactError, match="its values are not those of its schema"):
        Pipeline.of(configured).run()
    assert names(tmp_path) == before
    assert ran(Pipeline.of(configured).run()) == {"bvh"}


@pytest.mark.parametrize("name", ["config.yaml", "run.json", MARKER, "config.yaml/x"])
def test_no_result_replaces_what_a_run_leaves_of_itself(out, configured, name):
    republished(out, name)
    before = (out / "config.yaml").read_bytes()
    with pytest.raises(DamagedArtifactError, match=f"names a file {re.escape(repr(name))}, which belongs to the run"):
        Pipeline.of(configured).run()
    assert (out / "config.yaml").read_bytes() == before
    assert ran(Pipeline.of(configured).run()) == {"bvh"}


def test_labels_come_back_to_the_vertices_of_every_file(out):
    group = zarr.open_group(out / "segmentation.zarr", mode="r")
    body = spider()
    label, begin, end = (group[name][...] for name in ("label", "begin", "end"))
    for frame in range(12):
        labels = label[begin[frame] : end[frame]]
        np.testing.assert_array_equal(labels[1:], body.label[order(frame)][1:])
        assert labels[0] == -1
    assert group["aligned"].shape == (12, len(body.vertices), 3)
    assert group["label"].metadata.dimension_names == ("input_vertex",)


def test_skeleton_that_moved_the_body_explains_it(configured, out):
    result = Pipeline.of(configured).artifact("segmentation")
    assert result.error < 1e-6
    assert "distance between the skinned mesh and the aligned meshes" in views.remarks(result)[0]


def test_own_meshes_come_back_with_their_parts(out, scans, tmp_path):
    export(str(out), "ply", tmp_path / "coloured")
    assert names(tmp_path / "coloured") == [f"frame_{t:04d}.ply" for t in range(12)]
    exported = trimesh.load(tmp_path / "coloured" / "frame_0003.ply", process=False)
    scan = trimesh.load(scans / "0003.ply", process=False)
    np.testing.assert_allclose(exported.vertices, scan.vertices, atol=1e-6)
    np.testing.assert_array_equal(exported.faces, scan.faces)
    part = exported.metadata["_ply_raw"]["vertex"]["data"]["part"]
    np.testing.assert_array_equal(part[1:], spider().label[order(3)][1:])
    colour = exported.visual.vertex_colors
    assert (colour[part == -1, :3] == 255).all()
    assert len(np.unique(colour[part >= 0], axis=0)) == len(set(part.tolist()) - {-1})


@pytest.mark.parametrize(
    ("form", "expected"),
    [
        ("glb", ["skeleton.glb"]),
        ("csv", ["angles.csv", "bones.csv", "confidence.csv", "joints.csv", "motion.csv", "positions.csv", "turns.csv"]),
        ("rignet", ["skeleton.obj", "skeleton.txt"]),
    ],
)
def test_export_writes_into_a_folder_that_is_named(out, tmp_path, form, expected):
    (tmp_path / "there").mkdir()
    export(str(out), form, tmp_path / "there")
    assert names(tmp_path / "there") == expected


def test_export_names_a_single_file_as_it_is_told(out, tmp_path, capsys):
    before = (out / "run.json").read_bytes()
    export(str(out), "glb", tmp_path / "deep" / "walk.glb", ["glb.scale=0.5"])
    assert names(tmp_path / "deep") == ["walk.glb"]
    assert (tmp_path / "deep" / "walk.glb").read_bytes() != (out / "skeleton.glb").read_bytes()
    assert capsys.readouterr().out == f"{tmp_path}/deep/walk.glb\n"
    assert (out / "run.json").read_bytes() == before


def test_export_without_a_place_goes_into_the_folder_of_the_run(out, capsys):
    export(str(out), "csv")
    assert "tables" in names(out)
    assert str(out / "tables") in capsys.readouterr().out
    export(str(out), "bvh", as_json=True)
    assert json.loads(capsys.readouterr().out) == {"files": [str(out / "skeleton.bvh")], "remarks": []}


def test_zarr_is_exported_whole_and_over_nothing_else(out, tmp_path):
    export(str(out), "zarr", tmp_path / "labels.zarr")
    assert zarr.open_group(tmp_path / "labels.zarr", mode="r")["label"].size == 12 * len(spider().vertices)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("all I have")
    zarr.create_group(tmp_path / "other.zarr", attributes={"kinetree": "of another kind"})
    for other in ("mine", "other.zarr"):
        with pytest.raises(StoreError, match="was written by another program"):
            export(str(out), "zarr", tmp_path / other)
    assert names(tmp_path / "mine") == ["thesis.txt"]
    assert names(tmp_path / "other.zarr") == ["zarr.json"]


def test_export_before_there_is_a_skeleton_says_what_is_missing(configured, tmp_path):
    pipeline = Pipeline.of({**configured, "skeleton": {"fails": True}})
    pipeline.run()
    for form in ("glb", "csv", "ply", "rignet"):
        with pytest.raises(
            UnknownNodeError,
            match=r"from (complete_)?skeleton.* no up-to-date result: .*skeleton: stale.*; kinetree run computes",
        ):
            export(str(tmp_path / "out"), form, tmp_path / "x")
    assert not (tmp_path / "x").exists()


def test_export_of_what_was_never_run_says_so(configured, tmp_path):
    shutil.rmtree(tmp_path / "out")
    (tmp_path / "walk.yaml").write_text(json.dumps(configured))
    with pytest.raises(
        UnknownNodeError, match=r"from mesh\[frame=0\] and \d+ more, which has no up-to-date result: mesh\[frame=0\]: stale"
    ):
        export(str(tmp_path / "walk.yaml"), "glb")
    assert not (tmp_path / "out").exists()


def test_frames_without_alignment_are_named(out, scans, tmp_path, configured):
    pipeline = Pipeline.of(configured)
    for frame in (3, 4):
        pipeline.store.discard(pipeline.why(f"projection[frame={frame}]").artifact)
    with pytest.raises(UnknownNodeError, match=r"ply is made from projection\[frame=3\] and 1 more, which has no up-to-date"):
        export(str(out), "ply", tmp_path / "x")
    assert not (tmp_path / "x").exists()


def test_unknown_format_names_the_nearest(out):
    with pytest.raises(ConfigError, match="--to glbb: no such format; did you mean 'glb'"):
        export(str(out), "glbb")
    with pytest.raises(ConfigError, match="there are: blender, bvh, c3d, csv, glb"):
        export(str(out), "dae")
    with pytest.raises(ConfigError, match="--to FBX: Blender writes it, by the script that --to blender leaves"):
        export(str(out), "FBX")


def test_names_are_a_style_or_a_file_that_was_written_and_edited(out, tmp_path, capsys):
    export(str(out), "names", tmp_path / "names.yaml")
    text = (tmp_path / "names.yaml").read_text()
    assert text.splitlines()[:2] == ["trunk: trunk", "arm: arm"]
    (tmp_path / "names.yaml").write_text(text.replace("arm: arm", "arm: jaw"))
    export(str(out), "bvh", tmp_path / "named.bvh", names=str(tmp_path / "names.yaml"))
    assert "JOINT jaw" in (tmp_path / "named.bvh").read_text()
    capsys.readouterr()
    export(str(out), "names", names=str(tmp_path / "names.yaml"))
    assert "arm: jaw\n" in capsys.readouterr().out
    pipeline = Pipeline.of(str(out))
    export(str(out), "glb", tmp_path / "styled.glb", names="mixamo")
    assert (tmp_path / "styled.glb").is_file()
    assert Pipeline.of(str(out)).config == pipeline.config


def test_names_that_are_no_style_and_no_file_of_names_are_refused(out, tmp_path):
    with pytest.raises(ConfigError, match="--names mixamoo: neither a style nor a file; did you mean 'mixamo'"):
        export(str(out), "bvh", names="mixamoo")
    for text in ("- arm\n", "arm: [1]\n", "arm:\n", "3: arm\n"):
        (tmp_path / "names.yaml").write_text(text)
        with pytest.raises(ConfigError, match=r"names\.yaml: expected a line 'joint: name'"):
            export(str(out), "bvh", names=str(tmp_path / "names.yaml"))


def test_names_of_joints_that_are_not_there_are_told_and_too_long_ones_refused(out, tmp_path, capsys):
    (tmp_path / "names.yaml").write_text("arm: jaw\nelbow: x\n")
    export(str(out), "bvh", tmp_path / "named.bvh", names=str(tmp_path / "names.yaml"))
    printed = capsys.readouterr().err
    assert f"{tmp_path}/names.yaml: no joint that was found is called elbow\n" in printed
    assert "arm" not in printed
    export(str(out), "bvh", tmp_path / "again.bvh", ["joint_names.rename={arm: jaw, elbow: x}"])
    assert "joint_names.rename: no joint that was found is called elbow\n" in capsys.readouterr().err
    export(str(out), "bvh", tmp_path / "again.bvh", ["joint_names.rename={arm: a b}"])
    assert "joint_names.rename: names in bvh are of a-z, A-Z, 0-9 and _: 'a b' is a_b\n" in capsys.readouterr().err
    export(str(out), "glb", tmp_path / "again.glb", ["joint_names.rename={arm: a b, tail: hand}"])
    told = capsys.readouterr().err
    assert "joint_names.rename: a name that another joint has gets a number: hand is hand_2\n" in told
    assert "a-z" not in told
    (tmp_path / "names.yaml").write_text(f"arm: {'x' * 101}\n")
    with pytest.raises(ConfigError, match="has 101 letters; 100 are the most"):
        export(str(out), "bvh", names=str(tmp_path / "names.yaml"))


def test_run_and_plan_take_a_style(out, capsys):
    assert not command_line(EXPORTING)(["plan", str(out), "--names", "vrm", "--json"], standalone_mode=False)
    rows = {row["task"]: row for row in json.loads(capsys.readouterr().out)["tasks"]}
    assert rows["joint_names"]["states"] == {"stale": 1}
    assert not command_line(EXPORTING)(["run", str(out), "--names", "vrm"], standalone_mode=False)
    assert Pipeline.of(str(out)).config.params["joint_names"].style == "vrm"


def test_place_that_cannot_be_written_is_told_and_nothing_is_half_written(out, tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(StoreError, match="cannot write"):
        export(str(out), "csv", tmp_path / "file")
    assert (tmp_path / "file").read_text() == "mine"
    with pytest.raises(StoreError, match="cannot write"):
        export(str(out), "glb", tmp_path / "file" / "walk.glb")


def test_tables_that_cannot_all_be_written_are_not_there_at_all(out, tmp_path, monkeypatch):
    schedule, whole = Pipeline.of(str(out)).computed("tables").schedule, Path.write_bytes

    def full(path, data):
        if path.name == "bones.csv":
            raise OSError(errno.ENOSPC, "No space left on device")
        return whole(path, data)

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(StoreFullError, match="no space left"):
        write_elsewhere(tmp_path / "tables", schedule, "tables")
    assert names(tmp_path) == ["out"]


def test_own_input_is_never_overwritten(out, scans):
    before = (scans / "0003.ply").read_bytes()
    with pytest.raises(ConfigError, match="the input is read from it"):
        export(str(out), "glb", scans / "0003.ply")
    assert (scans / "0003.ply").read_bytes() == before
    frames = names(scans)
    with pytest.raises(ConfigError, match="the input is all files of this kind in this folder"):
        export(str(out), "glb", scans)
    for form in ("csv", "rignet"):
        with pytest.raises(ConfigError, match=f"{scans}: the input is the files in this folder; name another with --output"):
            export(str(out), form, scans)
    assert names(scans) == frames


@pytest.mark.parametrize(
    ("form", "name", "known"),
    [
        ("usd", "z.usdz", ".usda or .usd"),
        ("usd", "z.usdc", ".usda or .usd"),
        ("glb", "z.bvh", ".glb"),
        ("glb", "precious.json", ".glb"),
        ("zarr", "precious.json", ".zarr"),
        ("names", "precious.json", ".yaml, .yml or .txt"),
        ("json-schema", "names.yaml", ".json"),
    ],
)
def test_a_file_is_named_as_its_kind_is_and_replaces_none_of_another(out, tmp_path, form, name, known):
    for there in (False, True):
        if there:
            (tmp_path / name).write_text("mine")
        with pytest.raises(ConfigError, match=f"{name}: what is written there ends in {re.escape(known)}; name it so"):
            export(str(out), form, tmp_path / name)
        assert (tmp_path / name).exists() == there
    assert (tmp_path / name).read_text() == "mine"


@pytest.mark.parametrize("name", ["walk.usda", "walk.USD"])
def test_usd_is_written_as_text_by_both_names_that_readers_take(out, tmp_path, name):
    export(str(out), "usd", tmp_path / name)
    assert (tmp_path / name).read_bytes().startswith(b"#usda")


@pytest.mark.parametrize("form", ["json", "zarr"])
def test_a_file_without_an_ending_is_not_replaced(out, tmp_path, form):
    (tmp_path / "Makefile").write_text("mine")
    with pytest.raises(ConfigError, match=f"Makefile: what is written there ends in .{form}"):
        export(str(out), form, tmp_path / "Makefile")
    assert (tmp_path / "Makefile").read_text() == "mine"


def test_what_is_neither_file_nor_folder_is_never_replaced(out, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(ConfigError, match="neither a file nor a folder, and would be overwritten"):
        export(str(out), "glb", tmp_path / "pipe")
    assert (tmp_path / "pipe").is_fifo()


def test_missing_extra_says_what_to_install(out, monkeypatch, tmp_path):
    monkeypatch.setitem(EXTRAS, "usd", "no_such_package")
    with pytest.raises(InputError, match=r"--to usd needs a package.*pip install 'kinetree\[usd\]'"):
        export(str(out), "usd", tmp_path / "x.usda")
    assert not (tmp_path / "x.usda").exists()


def test_failed_export_names_node_and_cause(out, monkeypatch, tmp_path):
    def broken(skeleton):
        raise ValueError("no ink")

    monkeypatch.setattr("kinetree.tasks.results.formats.rignet._mesh", broken)
    with pytest.raises(NodesFailedError, match="rignet: ValueError: no ink"):
        export(str(out), "rignet", tmp_path / "x")


def test_schema_is_published_without_a_run(tmp_path, capsys):
    export(None, "json-schema")
    assert json.loads(capsys.readouterr().out)["title"] == "Document"
    export(None, "json-schema", tmp_path / "schema.json")
    assert json.loads((tmp_path / "schema.json").read_text())["title"] == "Document"
    with pytest.raises(ConfigError, match="cannot be written"):
        export(None, "json-schema", tmp_path / "no" / "schema.json")


def test_shown_skeleton_is_a_tree_with_lengths_turns_and_support(out, capsys):
    assert not command_line(EXPORTING)(["show", "skeleton", str(out)], standalone_mode=False)
    lines = [line.rstrip() for line in capsys.readouterr().out.splitlines()]
    at = next(n for n, line in enumerate(lines) if line.startswith("trunk"))
    assert lines[at : at + 7] == [
        "trunk       root, 12 frames",
        "├─ arm      bone 4 mm, turns 172°, ±0.01 mm, supported by 12 of 12 frames",
        "│  └─ hand  bone 4.123 mm",
        "├─ tail     bone 6.782 mm",
        "└─ knee     bone 5.831 mm, turns 133°, ±0.01 mm, supported by 12 of 12 frames",
        "   ├─ foot  bone 4.123 mm",
        "   └─ spur  bone 3.742 mm",
    ]


def test_a_store_that_cannot_be_written_is_told_beside_what_is_written(out, tmp_path, monkeypatch, capsys):
    beside = Folder._beside

    def refuse(place):
        if place.root.name == "store":
            raise OSError(errno.EACCES, os.strerror(errno.EACCES))
        return beside(place)

    monkeypatch.setattr(Folder, "_beside", refuse)
    changed = ["joint_names.rename={arm: jaw}"]
    export(str(out), "trc", tmp_path / "walk.trc", changed, as_json=True)
    printed = capsys.readouterr()
    (remark,) = [text for text in json.loads(printed.out)["remarks"] if "nothing is kept" in text]
    assert re.fullmatch(r"store .*/store: cannot write .*: Permission denied; .*; computed in memory, nothing is kept", remark)
    assert printed.err == ""
    for to, name in (("trc", "walk-again.trc"), ("names", "walk.yaml")):
        export(str(out), to, tmp_path / name, changed)
        assert capsys.readouterr().err.count("computed in memory, nothing is kept\n") == 1
