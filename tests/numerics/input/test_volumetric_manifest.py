"""Laws of volumetric manifests: every form of version 2 names the same files; what leads elsewhere is refused in words."""

import json

import pytest

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input import volumetric_manifest
from kinetree.tasks.numerics.input.volumetric_manifest import manifest_in, read_manifest

DRACO = {"format": "draco", "frameRate": 25, "frameCount": 3}


def target(path="drc/[index][ext]", **changes):
    return {"version": "v2", "geometry": {"targets": {"drc": {**DRACO, **changes}}, "path": path}}


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "drc").mkdir()
    for t in (2, 10, 1):
        (tmp_path / "drc" / f"{t:05d}.drc").touch()
    (tmp_path / "drc" / "cover.drc").touch()
    return tmp_path


def read(folder, document, wanted=""):
    path = folder / "manifest.json"
    path.write_text(json.dumps(document))
    return read_manifest(path, wanted)


def refusal(folder, document, wanted=""):
    with pytest.raises(SourceError) as refused:
        read(folder, document, wanted)
    return str(refused.value)


@pytest.mark.parametrize(
    "document",
    [
        target(),
        target("[target]/[index].drc"),
        target("drc/[#####][ext]"),
        {"output": {"geometry": target()["geometry"]}, "input": {"geometry": {"path": "scans/frame_[0001-0003].obj"}}},
        {"Version": "v2", "DRCURLPattern": "drc/#####.drc", "GeometryFrameRate": 25, "GeometryFrameCount": 3},
    ],
)
def test_every_form_of_a_manifest_names_its_frames(folder, document):
    manifest = read(folder, document)
    assert [path.name for path in manifest.files] == ["00001.drc", "00002.drc", "00010.drc"]
    assert (manifest.numbers, manifest.holds, manifest.length, manifest.fps) == ((1, 2, 10), "file", 1, 25.0)
    assert manifest_in(folder) == folder / "manifest.json"


def test_finest_target_is_read_unless_one_is_named(folder):
    document = target("[target]/[index][ext]")
    document["geometry"]["targets"]["small"] = {**DRACO, "frameRate": 12, "frameCount": 1}
    (folder / "small").mkdir()
    (folder / "small" / "7.drc").touch()
    assert read(folder, document).fps == 25.0
    assert (read(folder, document, "small").fps, read(folder, document, "small").numbers) == (12.0, (7,))
    assert "source.clip big: its targets are drc, small" in refusal(folder, document, "big")


@pytest.mark.parametrize(
    ("document", "told"),
    [
        (target("/etc/[index][ext]"), "outside its folder"),
        (target("../drc/[index][ext]"), "outside its folder"),
        (target("https://host/[index][ext]"), "outside its folder"),
        (target("drc/frame[ext]"), "one [index] must stand for their numbers"),
        (target("x" * 5000 + "/[index][ext]"), "is no path of frames (OSError)"),
        (target("x/" * 50000 + "[index][ext]"), "is no path of frames (RecursionError)"),
        (target("elsewhere/[index][ext]"), "no file at elsewhere/0000000.drc"),
        (target(frameCount=4), "drc has 4 frames, but only 3 are there, in 3 files; copy the others too, or name their folder"),
        (target(frameCount=2), "drc has 2 frames, but 3 files are there; take the others away"),
        (target(frameRate=0), "frameRate is 0; a positive number"),
        (target(frameRate="fast"), "frameRate is fast; a positive number"),
        (target(frameCount=-1), "frameCount is -1; a positive whole number"),
        (target(format="corto"), "'corto'; draco, obj, glb, gltf, uniform-solve are read"),
        (target(format="uniform-solve"), "no file at drc/0000000.glb"),
        ({"version": "v2", "geometry": {"targets": {}, "path": "[target]/[index]"}}, "it has no targets"),
        ({"frameRate": 30, "maxVertices": 9, "frameData": [{"frameNumber": 0}]}, "is Universal Volumetric 1"),
        ({"version": "v2", "geometry": {"frameData": [0, 9], "compression": "draco"}}, "packed together"),
        ({"joints": []}, "no manifest of Universal Volumetric 2"),
        ([1, 2], "no manifest of Universal Volumetric 2"),
    ],
)
def test_what_cannot_be_read_ends_in_what_to_do(folder, document, told):
    assert told in refusal(folder, document)


def test_of_targets_of_one_rate_that_with_the_finest_positions_is_read(folder):
    document = target("[target]/[index][ext]", settings={"positionQuantizationBits": 8})
    for name, settings in (("fine", {"positionQuantizationBits": 14}), ("usual", {})):
        document["geometry"]["targets"][name] = {**DRACO, "frameCount": 1, "settings": settings}
        (folder / name).mkdir()
        (folder / name / "1.drc").touch()
    assert read(folder, document).files == (folder / "fine" / "1.drc",)
    del document["geometry"]["targets"]["fine"]
    assert read(folder, document).files == (folder / "usual" / "1.drc",)


@pytest.mark.parametrize("name", ["g#1", "g[index]", "g[ext]", "[g]"])
def test_target_may_be_called_as_places_of_a_path_are(folder, name):
    document = {"geometry": {"targets": {name: DRACO}, "path": "[target]/[index][ext]"}}
    (folder / "drc").rename(folder / name)
    assert read(folder, document).numbers == (1, 2, 10)


@pytest.mark.parametrize("claimed", [2, 4])
def test_sequence_that_still_grows_may_have_other_files(folder, claimed):
    path = folder / "manifest.json"
    path.write_text(json.dumps(target(frameCount=claimed)))
    assert len(read_manifest(path, is_growing=True).files) == 3


def test_frames_and_files_of_segments_are_counted_apart(folder):
    for t in range(3):
        (folder / f"{t}.glb").touch()
    segments = {"format": "uniform-solve", "segmentFrameCount": 2}
    assert len(read(folder, target("[index][ext]", **segments, frameCount=5)).files) == 3
    assert "has 7 frames, but only 6 are there, in 3 files; copy" in refusal(
        folder, target("[index][ext]", **segments, frameCount=7)
    )
    assert "has 4 frames, but 3 files are there" in refusal(folder, target("[index][ext]", **segments, frameCount=4))


def test_frames_beside_an_incomplete_manifest_are_named_by_a_pattern(folder):
    (folder / "1.drc").touch()
    assert refusal(folder, target("[index][ext]", frameCount=2)).endswith(f"or name {folder}/*.drc")


def test_numbers_beyond_those_that_frames_may_have_are_refused(folder):
    (folder / "drc" / "9999999999.drc").touch()
    assert "frame 9999999999 is beyond the last number that a frame may have" in refusal(folder, target())
    (folder / "drc" / "9999999999.drc").rename(folder / "drc" / "1.glb")
    segments = target(format="uniform-solve", segmentFrameCount=10**9)
    assert "frame 1000000000 is beyond the last number" in refusal(folder, segments)


def test_two_files_of_one_number_are_refused(folder):
    (folder / "drc" / "1.drc").touch()
    assert "has the number of another file" in refusal(folder, target())


def test_folder_without_a_manifest_has_none(folder):
    (folder / "truth.json").write_text('{"joints": []}')
    (folder / "notes.json").write_text("not JSON")
    assert manifest_in(folder) is None


def test_a_manifest_is_found_among_files_too_large_to_look_through(folder, monkeypatch):
    (folder / "manifest.json").write_text(json.dumps(target()))
    (folder / "a.json").write_text(json.dumps(target()).ljust(1990))
    monkeypatch.setattr(volumetric_manifest, "LARGEST", 2000)
    assert manifest_in(folder) == folder / "manifest.json"


def test_two_manifests_are_not_chosen_from(folder):
    for name in ("a.json", "b.json"):
        (folder / name).write_text(json.dumps(target()))
    with pytest.raises(SourceError, match=r"a\.json and b\.json are manifests; name one of them"):
        manifest_in(folder)
