"""Contracts of finding frames: which frames there are, what each is, and that what is read is what was planned."""

import os
import re
import shutil
import zipfile

import numpy as np
import pytest
import trimesh
import zarr
from numerics.input.animated_glbs import TENTHS, GlbDraft

from kinetree.errors import MeshError, SourceError
from kinetree.pipeline.identity.key import artifact_digest
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.source import Source, SourceParams
from kinetree.tasks.input.frames.read import name, surface
from kinetree.tasks.input.source import source
from kinetree.tasks.numerics.input.frame_numbers import TAKE

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def off(scale=1.0):
    rows = [" ".join(map(str, v)) for v in V * scale] + ["3 " + " ".join(map(str, f)) for f in F]
    return "OFF\n4 4 0\n" + "\n".join(rows) + "\n"


def packed(frames=3, **changes):
    arrays = {
        "vertices": np.concatenate([V * (1 + t / 10) for t in range(frames)]), "faces": F,
        "vertex_offsets": np.arange(frames + 1) * 4, "face_offsets": np.array([0, 4]),
        "fps": np.array(25.0), "unit": np.array("mm"),
    }  # fmt: skip
    return {key: a for key, a in {**arrays, **changes}.items() if a is not None}


@pytest.fixture
def files(tmp_path):
    return Files.of(Store.at(tmp_path / "store"))


@pytest.fixture
def frames_of(files, tmp_path):
    """The frames at a path below the test's folder."""

    def find(where, frames=":", **params):
        return source(SourceParams(input=str(tmp_path / where), frames=frames, **params), files)

    return find


@pytest.fixture
def scans(tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    for t in (1, 2, 10, 9):
        (folder / f"frame_{t}.off").write_text(off(1 + t / 10))
    return folder


def as_npz(path, **changes):
    np.savez(path, **packed(**changes))


def as_zarr(path, **changes):
    arrays = packed(**changes)
    group = zarr.create_group(path, attributes={k: arrays.pop(k).item() for k in ("fps", "unit") if k in arrays})
    for key, array in arrays.items():
        group.create_array(key, data=array)


PACKED = pytest.mark.parametrize(
    ("where", "write"),
    [("a.npz", as_npz), ("a.zarr", as_zarr), ("a", as_zarr)],
    ids=lambda x: str(x)[:9],
)

# ── one file of all frames ──────────────────────────────────────────────────────────────────────────────────────────


def zip_of(path, frames):
    with zipfile.ZipFile(path, "w") as file:
        for t, content in frames.items():
            file.writestr(f"walk/frame_{t}.off", content)


def test_zip_of_frames_has_the_numbers_of_their_names(frames_of, tmp_path):
    zip_of(tmp_path / "walk.zip", {t: off(1 + t / 10) for t in (1, 2, 9, 10)})
    frames = frames_of("walk.zip")
    assert list(frames) == [1, 2, 9, 10]
    assert {s.kind for s in frames.values()} == {"animated"}
    np.testing.assert_array_equal(surface(frames[9])[0], V * 1.9)
    zip_of(tmp_path / "walk.zip", {t: off(2) for t in (1, 2, 9, 10)})
    with pytest.raises(SourceError, match=r"^walk\.zip, frame 2: the file changed while the run was under way; run again$"):
        surface(frames[9])


def test_damaged_member_of_a_zip_is_a_bad_frame_and_no_more(frames_of, tmp_path):
    zip_of(tmp_path / "walk.zip", {t: off(1) if t != 5 else off(1)[:30] for t in range(12)})
    frames = frames_of("walk.zip")
    assert list(frames) == [t for t in range(12) if t != 5]
    ((bad,),) = [s.dropped for s in frames.values() if s.dropped]
    assert bad.frame == 5
    assert "the file is cut short" in bad.reason


def test_clip_of_what_is_no_glb_is_refused(files, scans):
    with pytest.raises(
        SourceError,
        match=r"source\.clip wave: names an animation of one GLB or a target .*, and .*scans is none; leave it out",
    ):
        source(SourceParams(input=str(scans), clip="wave"), files)
    with pytest.raises(SourceError, match=r"and s3://bucket/scans is none"):
        source(SourceParams(input="s3://bucket/scans", clip="wave"), files)


def test_animated_glb_is_a_sequence_and_its_clips_have_names(frames_of, files, tmp_path):
    glb = GlbDraft().moves("translation", TENTHS / 3, np.outer(TENTHS, [1, 2, 3]))
    glb.moves("translation", [0, 2], [[0, 0, 0], [0, 0, 0.1]], name="wave")
    (tmp_path / "walk.glb").write_bytes(glb.raw())
    frames = frames_of("walk.glb")
    assert (list(frames), frames[3].fps, frames[3].unit) == (list(range(11)), 30.0, "m")
    np.testing.assert_allclose(surface(frames[10])[0][0], [1, 2, 3], atol=1e-6)
    wave = source(SourceParams(input=str(tmp_path / "walk.glb"), clip="wave"), files)
    assert (len(wave), wave[0].clip) == (49, "wave")
    np.testing.assert_allclose(surface(wave[48])[0][0], [0, 0, 0.1], atol=1e-6)
    with pytest.raises(SourceError, match=r"source\.clip dance: there is walk, wave"):
        source(SourceParams(input=str(tmp_path / "walk.glb"), clip="dance"), files)


@pytest.mark.parametrize(
    ("suffix", "advice"),
    [
        (".fbx", "kinetree convert makes a sequence of it where Blender is installed"),
        (".abc", "kinetree convert makes a sequence of it where Blender is installed"),
        (".gltf", "export it as one binary glTF"),
        (".pcd", "is a cloud of points; make a surface of every frame first"),
        (".bvh", "holds a skeleton or markers, no surface"),
        (".mp4", "holds pictures, no surface"),
        (".uvol", "unpack it"),
    ],
)
def test_formats_that_are_not_read_end_in_what_to_do(frames_of, tmp_path, suffix, advice):
    (tmp_path / "many").mkdir()
    for where in ("many/a1", "many/a2", "a"):
        (tmp_path / f"{where}{suffix}").write_text("something")
    for where in ("many", f"a{suffix}"):
        with pytest.raises(SourceError, match=advice):
            frames_of(where)


# ── folders and patterns ────────────────────────────────────────────────────────────────────────────────────────────


def test_folder_is_frames_in_natural_order_with_the_numbers_of_their_names(frames_of, scans):
    frames = frames_of("scans")
    assert list(frames) == [1, 2, 9, 10]
    assert {s.series for s in frames.values()} == {(1, 10)}
    assert [name(s) for s in frames.values()] == ["frame_1.off", "frame_2.off", "frame_9.off", "frame_10.off"]
    assert all((s.part, s.kind, s.fps, s.unit) == (None, "file", None, None) for s in frames.values())


def test_pattern_chooses_files(frames_of, scans):
    (scans / "frame_3.obj").write_text("")
    assert [name(s) for s in frames_of("scans/*.off").values()] == ["frame_1.off", "frame_2.off", "frame_9.off", "frame_10.off"]
    assert [name(s) for s in frames_of("scans/frame_1*.off").values()] == ["frame_1.off", "frame_10.off"]


@pytest.mark.parametrize(
    ("frames", "numbers"),
    [(":", [1, 2, 9, 10]), ("1:3", [1, 2]), ("::2", [1, 9]), ("-2:", [9, 10]), ("2:99", [2, 9, 10]), (" 1 : 11 : 9 ", [1, 10])],
)
def test_chosen_frames_keep_their_numbers(frames_of, scans, frames, numbers):
    whole, chosen = frames_of("scans"), frames_of("scans", frames)
    assert list(chosen) == numbers
    assert all(chosen[t] == whole[t] for t in numbers)


def test_frame_is_its_bytes_whatever_its_name_age_and_folder(frames_of, scans, tmp_path):
    before = {t: artifact_digest(s) for t, s in frames_of("scans").items()}
    os.utime(scans / "frame_1.off", (1, 1))
    shutil.copytree(scans, tmp_path / "moved")
    for t in (1, 2, 9, 10):
        (tmp_path / "moved" / f"frame_{t}.off").rename(tmp_path / "moved" / f"walk_{t}.off")
    assert {t: artifact_digest(s) for t, s in frames_of("moved").items()} == before
    (scans / "frame_2.off").write_text(off(1.7))
    after = {t: artifact_digest(s) for t, s in frames_of("scans").items()}
    assert [t for t in before if before[t] != after[t]] == [2]


def test_surface_is_the_users_own_vertices_and_faces(frames_of, scans):
    vertices, faces = surface(frames_of("scans")[2])
    np.testing.assert_array_equal(vertices, V * 1.2)
    np.testing.assert_array_equal(faces, F)


def test_file_that_changes_between_planning_and_reading_is_refused(frames_of, scans):
    frames = frames_of("scans")
    (scans / "frame_2.off").write_text(off(3))
    with pytest.raises(SourceError, match=r"^frame_2\.off: the file changed while the run was under way; run again$"):
        surface(frames[2])
    surface(frames[1])


def test_file_that_vanishes_between_planning_and_reading_is_refused(frames_of, scans):
    frames = frames_of("scans")
    (scans / "frame_2.off").unlink()
    with pytest.raises(MeshError, match=r"frame_2\.off: there is no such file"):
        surface(frames[2])


def test_frame_that_is_spoilt_is_dropped_and_named_by_the_one_before_it(files, scans):
    def usable(**changes):
        return source(SourceParams(input=str(scans), bad_share=0.5, **changes), files)

    before = usable()
    (scans / "frame_9.off").write_text(off(1900.0))
    after = usable()
    assert list(after) == [1, 2, 10]
    (bad,) = after[2].dropped
    assert (bad.frame, after[1].dropped, after[10].dropped) == (9, (), ())
    assert bad.reason.startswith("its size is ")
    assert bad.reason.endswith("is it in another unit?")
    assert [t for t in after if artifact_digest(after[t]) != artifact_digest(before[t])] == [2]
    (scans / "frame_9.off").write_text(off(1.9))
    (scans / "frame_1.off").write_text("hello")
    ((named_by, reason),) = [(t, s.dropped[0].reason) for t, s in usable().items() if s.dropped]
    assert named_by == 2
    assert reason.startswith("frame_1.off: does not begin with OFF")
    assert list(usable(frames="2:")) == [2, 9, 10]
    with pytest.raises(SourceError, match=r"1 of 4 frames cannot be used \(set source\.on_bad.*frame 1: frame_1\.off"):
        usable(on_bad_frame="fail")


def test_bad_frames_that_leave_less_than_two_are_refused(files, scans):
    for t in (2, 9, 10):
        (scans / f"frame_{t}.off").write_text("hello")
    with pytest.raises(SourceError, match="3 of 4 frames cannot be used"):
        source(SourceParams(input=str(scans), bad_share=0.9), files)


@PACKED
def test_packed_frame_of_another_size_is_dropped(frames_of, tmp_path, where, write):
    scales = [1, 1.1, 1000, 1.2, 1.1, 1]
    write(tmp_path / where, frames=6, vertices=np.concatenate([V * s for s in scales]))
    frames = frames_of(where)
    assert list(frames) == [0, 1, 3, 4, 5]
    assert [bad.frame for bad in frames[1].dropped] == [2]


def test_second_body_numbered_on_in_the_folder_is_refused_dropped_or_kept_as_wished(frames_of, tmp_path):
    box = trimesh.creation.box((1, 2, 5))
    for t in range(16):
        heavier = 1.05 if t >= 10 else 1.0
        trimesh.Trimesh(box.vertices * heavier + [0.1 * t, 0, 0], box.faces).export(tmp_path / f"frame_{t:03d}.off")
    with pytest.raises(SourceError, match=r"^6 of 16 frames cannot be used .*: frames 10 to 15 show another body: "):
        frames_of(tmp_path)
    first_body = frames_of(tmp_path, bad_share=0.4)
    assert list(first_body) == list(range(10))
    assert [bad.frame for bad in first_body[9].dropped] == list(range(10, 16))
    assert len(frames_of(tmp_path, other_body="keep")) == 16
    with pytest.raises(SourceError, match="set source.on_bad_frame=drop"):
        frames_of(tmp_path, on_bad_frame="fail", bad_share=0.4)


# ── all frames in one file ──────────────────────────────────────────────────────────────────────────────────────────


@PACKED
def test_packed_sequence_is_its_frames_with_rate_and_unit(frames_of, tmp_path, where, write):
    write(tmp_path / where)
    frames = frames_of(where)
    assert list(frames) == [0, 1, 2]
    assert {(s.fps, s.unit) for s in frames.values()} == {(25.0, "mm")}
    assert name(frames[2]) == f"{where}, frame 2"
    for t, each in frames.items():
        vertices, faces = surface(each)
        np.testing.assert_array_equal(vertices, V * (1 + t / 10))
        np.testing.assert_array_equal(faces, F)


@PACKED
def test_packed_sequence_without_rate_and_unit_knows_none(frames_of, tmp_path, where, write):
    write(tmp_path / where, fps=None, unit=None)
    assert {(s.fps, s.unit) for s in frames_of(where).values()} == {(None, None)}


@PACKED
def test_packed_frames_keep_their_identity_when_others_are_appended_or_changed(frames_of, tmp_path, where, write):
    write(tmp_path / where)
    before = {t: artifact_digest(s) for t, s in frames_of(where).items()}
    path = tmp_path / where
    shutil.rmtree(path) if path.is_dir() else path.unlink()
    write(path, frames=4, vertices=np.concatenate([V, 1.9 * V, 1.2 * V, 1.3 * V]))
    after = {t: artifact_digest(s) for t, s in frames_of(where).items()}
    assert [t for t in before if before[t] == after[t]] == [0, 2]
    assert len(after) == 4


@pytest.mark.parametrize(("where", "write"), [("a.npz", as_npz), ("a.zarr", as_zarr)])
def test_packed_sequence_that_changes_between_planning_and_reading_is_refused(frames_of, tmp_path, where, write):
    write(tmp_path / where)
    frames = frames_of(where)
    surface(frames[1])
    if where.endswith("zarr"):
        zarr.open_group(tmp_path / where)["vertices"][4:8] = 1.9 * V  # in place: only a chunk changes
    else:
        write(tmp_path / where, vertices=np.concatenate([V, 1.9 * V, 1.2 * V]), unit=np.array("cm"))
    with pytest.raises(SourceError, match=f"^{where}, frame 1: the file changed while the run was under way; run again$"):
        surface(frames[1])
    surface(frames[0])


def test_same_mesh_in_npz_and_zarr_is_the_same_but_for_how_it_is_read(frames_of, tmp_path):
    as_npz(tmp_path / "a.npz")
    as_zarr(tmp_path / "a.zarr")
    assert [s.content for s in frames_of("a.npz").values()] == [s.content for s in frames_of("a.zarr").values()]


@pytest.mark.parametrize("unit", ["it's", 'say "mm"', "a\\b", "a\nb", "None", "µm"])
def test_unit_is_told_as_it_is_written(frames_of, tmp_path, unit):
    as_npz(tmp_path / "a.npz", unit=np.array(unit))
    assert frames_of("a.npz")[0].unit == unit


def test_damaged_zarr_is_refused_as_a_source_and_not_as_our_store(frames_of, tmp_path):
    as_zarr(tmp_path / "a.zarr")
    for chunk in (tmp_path / "a.zarr" / "vertices" / "c").rglob("*"):
        if chunk.is_file():
            chunk.write_bytes(b"x")
    with pytest.raises(SourceError, match=r"a\.zarr: not a readable zarr group"):
        frames_of("a.zarr")


# ── refusals ────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_no_input_says_what_to_give(files):
    with pytest.raises(SourceError, match=r"^no input: name a folder of meshes with --input, or source\.input in the config$"):
        source(SourceParams(), files)


@pytest.mark.parametrize("frames", ["", "1", "a:b", "1:2:3:4", "::0", "1.5:3"])
def test_frames_that_are_no_range_are_refused(frames_of, scans, frames):
    with pytest.raises(SourceError, match=r"write start:stop or start:stop:step, e\.g\. 10:60:2"):
        frames_of("scans", frames)


def test_frames_backwards_or_beyond_are_refused(frames_of, scans):
    with pytest.raises(SourceError, match="the step must be positive; time runs forward"):
        frames_of("scans", "::-1")
    with pytest.raises(SourceError, match="selects none of the 4 frames of"):
        frames_of("scans", "11:")


def test_single_frame_is_refused_because_nothing_moves(frames_of, scans):
    with pytest.raises(SourceError, match="^frames '1:2' selects a single frame; kinematics are seen in motion"):
        frames_of("scans", "1:2")


@pytest.mark.parametrize("where", ["none.npz", "none.zarr", "none"])
def test_missing_sequence_is_refused_by_name(frames_of, tmp_path, where):
    with pytest.raises(SourceError, match=f"^{tmp_path / where}: there is no such "):
        frames_of(where)


def test_source_that_is_told_by_hand_is_read_like_any_other(scans):
    with pytest.raises(SourceError, match="the file changed"):
        surface(Source(content="00", path=str(scans / "frame_1.off")))


def test_takes_are_numbered_one_after_the_other(files, scans, tmp_path):
    shutil.copytree(scans, tmp_path / "other")
    (tmp_path / "other" / "frame_9.off").write_text(off(1.95))
    takes = [{"name": "a", "input": str(scans)}, {"name": "b-2", "input": str(tmp_path / "other")}]
    numbered = source(SourceParams(takes=takes), files)
    own = source(SourceParams(input=str(tmp_path / "other")), files)
    assert list(numbered) == [*own, *(TAKE + t for t in own)]
    assert [numbered[t].take for t in numbered] == ["a"] * len(own) + ["b-2"] * len(own)
    assert [numbered[TAKE + t].content for t in own] == [own[t].content for t in own]


def test_the_same_frames_as_two_takes_are_refused(files, scans, tmp_path):
    (tmp_path / "link").symlink_to(scans)
    copy = shutil.copytree(scans, tmp_path / "copy")
    for same in (scans, tmp_path / "link", scans / ".." / scans.name, copy, scans / "*.off"):
        takes = [{"name": "a", "input": str(scans)}, {"name": "b", "input": str(same)}]
        words = rf"source\.takes: a and b have the same frames \({re.escape(str(same))}\); leave one of them out"
        with pytest.raises(SourceError, match=words):
            source(SourceParams(takes=takes), files)


def moving(folder, ending, shift=0.0, width=1.0):
    """Three frames of an egg that grows a nose, as a folder of files of a format."""
    folder.mkdir(exist_ok=True)
    for t in range(3):
        egg = trimesh.creation.icosphere(subdivisions=3)
        egg.vertices *= (width, 2.0, 3.0)
        egg.vertices[np.argmax(egg.vertices[:, 2])] += (0.0, shift, 0.1 * t)
        if ending == "drc":
            content = pytest.importorskip("DracoPy").encode(egg.vertices, egg.faces.astype(np.uint32), quantization_bits=11)
            (folder / f"frame_{t}.drc").write_bytes(content)
        else:
            egg.export(folder / f"frame_{t}.{ending}")
    return str(folder)


@pytest.mark.parametrize("ending", ["obj", "stl", "off", "glb", "drc", "npz"])
def test_the_same_frames_in_another_format_as_a_second_take_are_refused(files, tmp_path, ending):
    first, second = moving(tmp_path / "first", "ply"), str(tmp_path / "second.npz")
    if ending == "npz":
        eggs = [trimesh.load(tmp_path / "first" / f"frame_{t}.ply", process=False) for t in range(3)]
        count = np.cumsum([0, *(len(egg.vertices) for egg in eggs)])
        arrays = {"vertices": np.concatenate([egg.vertices for egg in eggs]), "vertex_offsets": count}
        np.savez(second, faces=eggs[0].faces, face_offsets=np.array([0, len(eggs[0].faces)]), **arrays)
    else:
        second = moving(tmp_path / "second", ending)
    takes = [{"name": "walk", "input": first}, {"name": "again", "input": second}]
    with pytest.raises(
        SourceError, match=rf"walk and again have the same frames \({re.escape(second)}\); leave one of them out"
    ):
        source(SourceParams(takes=takes), files)


def test_takes_that_differ_by_one_vertex_are_two(files, tmp_path):
    takes = [{"name": n, "input": moving(tmp_path / n, e, by)} for n, e, by in (("a", "ply", 0.0), ("b", "obj", 0.05))]
    assert len(source(SourceParams(takes=takes), files)) == 6


def test_a_body_that_stands_still_twice_is_two_takes_and_a_copy_of_one_is_not(files, tmp_path):
    egg = trimesh.creation.icosphere(subdivisions=3)
    egg.vertices *= (1.0, 2.0, 3.0)
    for take, seed in (("a", 0), ("b", 1)):
        rng = np.random.default_rng(seed)
        (tmp_path / take).mkdir()
        for t in range(6):
            moved = egg.vertices + rng.normal(scale=2e-4, size=egg.vertices.shape)
            trimesh.Trimesh(moved, egg.faces, process=False).export(tmp_path / take / f"frame_{t}.ply")
    copy = tmp_path / "copy"
    copy.mkdir()
    for file in (tmp_path / "b").iterdir():
        trimesh.load(file, process=False).export(copy / f"{file.stem}.obj")
    takes = [{"name": n, "input": str(tmp_path / n)} for n in ("a", "b", "copy")]
    assert len(source(SourceParams(takes=takes[:2]), files)) == 12
    with pytest.raises(SourceError, match="b and copy have the same frames"):
        source(SourceParams(takes=takes), files)


def test_takes_of_other_measures_are_not_read_again(files, tmp_path, monkeypatch):
    takes = [{"name": n, "input": moving(tmp_path / n, "ply", width=w)} for n, w in (("a", 1.0), ("b", 1.05))]
    monkeypatch.setattr("kinetree.tasks.input.source.surface", lambda _: pytest.fail("it is read"))
    assert len(source(SourceParams(takes=takes), files)) == 6


def test_takes_without_names_of_their_own_and_beside_an_input_are_refused(files, scans):
    one = {"name": "a", "input": str(scans)}
    with pytest.raises(SourceError, match="a, a: each take needs an input, and a name that differs"):
        source(SourceParams(takes=[one, one]), files)
    other = {"name": one["name"].upper(), "input": str(scans)}
    with pytest.raises(SourceError, match="differs from the others in more than capitals"):
        source(SourceParams(takes=[one, other]), files)
    with pytest.raises(SourceError, match="takes excludes source.input"):
        source(SourceParams(takes=[one], input=str(scans)), files)
