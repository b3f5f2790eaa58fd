"""Contracts of Universal Volumetric 2 as an input: its manifest, or its folder, is a sequence of meshes with a frame rate."""

import json

import numpy as np
import pytest
from numerics.input.animated_glbs import GlbDraft
from numerics.input.animated_glbs import V as TETRAHEDRON

from kinetree.errors import SourceError
from kinetree.pipeline.storage.files import Files, Settling
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.source import SourceParams
from kinetree.tasks.input.frames.listing import frames_at
from kinetree.tasks.input.frames.read import surface
from kinetree.tasks.input.source import source

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]], np.float32)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])


@pytest.fixture
def frames_of(tmp_path):
    files = Files.of(Store.at(tmp_path / "store"))
    return lambda where, **more: source(SourceParams(input=str(tmp_path / where), **more), files)


def take(folder, targets, path="geometry/[target]/[index][ext]"):
    """A folder with a manifest of version 2."""
    folder.mkdir()
    document = {"version": "v2", "duration": 1.0, "geometry": {"targets": targets, "path": path}}
    (folder / "manifest.json").write_text(json.dumps(document))
    return folder


def test_draco_frames_have_the_rate_of_their_manifest(frames_of, tmp_path):
    draco = pytest.importorskip("DracoPy", reason="pip install 'kinetree[draco]'")
    coarse = {"format": "draco", "frameRate": 15, "frameCount": 2, "settings": {"positionQuantizationBits": 8}}
    fine = {"format": "draco", "frameRate": 30, "frameCount": 3, "settings": {"positionQuantizationBits": 14}}
    folder = take(tmp_path / "take", {"coarse": coarse, "fine": fine})
    for target, frames in (("coarse", 2), ("fine", 3)):
        (folder / "geometry" / target).mkdir(parents=True)
        for t in range(frames):
            raw = draco.encode(V + np.float32(t), F, quantization_bits=16)
            (folder / "geometry" / target / f"{t:07d}.drc").write_bytes(raw)
    for where in ("take", "take/manifest.json"):
        frames = frames_of(where)
        assert (list(frames), frames[2].fps) == ([0, 1, 2], 30.0)
    np.testing.assert_allclose(np.sort(surface(frames[2])[0].sum(axis=1)), [6, 7, 7, 7], atol=1e-3)
    assert (len(frames_of("take", clip="coarse")), frames_of("take", clip="coarse")[0].fps) == (2, 15.0)


def segment(path, shifts):
    """A GLB of a frame for every shift."""
    glb = GlbDraft()
    glb.document["animations"] = []
    glb.primitive["targets"] = [{"POSITION": glb.add(np.full((4, 3), x, np.float32))} for x in shifts]
    path.write_bytes(glb.raw())


def test_morph_targets_of_segments_are_frames_one_after_the_other(frames_of, tmp_path):
    targets = {"glb": {"format": "uniform-solve", "frameRate": 10, "segmentFrameCount": 2, "frameCount": 4}}
    folder = take(tmp_path / "take", targets, "[target]_[index][ext]")
    for k in range(2):
        segment(folder / f"glb_{k:07d}.glb", (2 * k, 2 * k + 1))
    for where in ("take", "take/manifest.json"):
        frames = frames_of(where, clip="glb")
        stated = {f.fps for f in frames.values()}, {f.unit for f in frames.values()}
        assert (list(frames), *stated) == ([0, 1, 2, 3], {10.0}, {"m"})
        for t, frame in frames.items():
            np.testing.assert_allclose(surface(frame)[0], TETRAHEDRON + t, atol=1e-6)


def test_segments_that_still_come_are_read_as_far_as_they_are_complete(tmp_path):
    targets = {"glb": {"format": "uniform-solve", "frameRate": 10, "segmentFrameCount": 2, "frameCount": 6}}
    folder = take(tmp_path / "take", targets, "[target]_[index][ext]")
    settling = Settling()
    files = Files.of(Store.at(tmp_path / "store"), settling)
    for k in range(2):
        segment(folder / f"glb_{k:07d}.glb", (2 * k, 2 * k + 1))
    with pytest.raises(SourceError, match="no file is complete yet"):
        frames_at(str(folder), files)
    settling.look()
    (folder / "glb_0000001.glb").write_bytes(b"glTF, still being written")
    assert {t: frame.fps for t, frame in frames_at(str(folder), files).items()} == {0: 10.0, 1: 10.0}
    with pytest.raises(SourceError, match="has 6 frames, but only 4 are there, in 2 files"):
        frames_at(str(folder), Files.of(Store.at(tmp_path / "store")))


@pytest.mark.parametrize(
    "other",
    [
        {"joints": [[0, 1, 2]], "fps": 25},
        {"maxVertices": 9, "frameData": [{"frameNumber": 0}]},
        {"output": {"geometry": {"targets": {"drc": {}}, "path": "[target]/[index][ext]"}}, "input": {"geometry": {}}},
    ],
    ids=["truth", "version 1", "configuration of an encoder"],
)
def test_meshes_beside_json_that_is_no_manifest_of_theirs_are_frames_on_their_own(frames_of, tmp_path, other):
    (tmp_path / "take").mkdir()
    (tmp_path / "take" / "other.json").write_text(json.dumps(other))
    for t in range(2):
        rows = [*("v {} {} {}".format(*row) for row in V), *("f {} {} {}".format(*row) for row in F + 1)]
        (tmp_path / "take" / f"{t}.obj").write_text("\n".join(rows))
    frames = frames_of("take")
    assert (list(frames), frames[0].fps) == ([0, 1], None)


def test_a_manifest_its_folder_and_its_only_target_are_the_same_take(tmp_path):
    targets = {"glb": {"format": "uniform-solve", "frameRate": 10, "segmentFrameCount": 2}}
    folder = take(tmp_path / "take", targets, "[target]/[index][ext]")
    (folder / "glb").mkdir()
    glb = GlbDraft()
    glb.document["animations"] = []
    glb.primitive["targets"] = [{"POSITION": glb.add(np.full((4, 3), x, np.float32))} for x in range(2)]
    (folder / "glb" / "0.glb").write_bytes(glb.raw())
    files, one = Files.of(Store.at(tmp_path / "store")), {"name": "a", "input": str(folder)}
    for same in ({"input": str(folder / "manifest.json")}, {"input": str(folder), "clip": "glb"}):
        with pytest.raises(SourceError, match="a and b have the same frames"):
            source(SourceParams(takes=[one, {"name": "b", **same}]), files)


def test_a_segment_with_more_frames_than_its_manifest_says_is_refused(frames_of, tmp_path):
    targets = {"glb": {"format": "uniform-solve", "frameRate": 10, "segmentFrameCount": 2}}
    folder = take(tmp_path / "take", targets, "[target]_[index][ext]")
    segment(folder / "glb_0.glb", range(3))
    with pytest.raises(SourceError, match=r"glb_0\.glb: 3 frames, but manifest\.json says that a file has 2"):
        frames_of("take/manifest.json")


def test_glb_without_morph_targets_is_no_segment(frames_of, tmp_path):
    targets = {"glb": {"format": "uniform-solve", "frameRate": 10, "segmentFrameCount": 2}}
    folder = take(tmp_path / "take", targets, "[target]_[index][ext]")
    (folder / "glb_0.glb").write_bytes(GlbDraft().raw())
    with pytest.raises(SourceError, match="its meshes have 0 morph targets"):
        frames_of("take/manifest.json")
