"""Everything a careless or malicious user can give: one message that names the file or key and the remedy, and nothing lost."""

import errno
import io
import json
import os
import pickle
import signal
import struct
import subprocess
import sys
import zipfile
from pathlib import Path

import numpy as np
import pytest

from kinetree.pipeline.command_line import cli
from kinetree.tasks.application import main

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def off(V=V, F=F):
    rows = [" ".join(map(str, v)) for v in V] + [f"{len(f)} " + " ".join(map(str, f)) for f in F]
    return f"OFF\n{len(V)} {len(F)} 0\n" + "\n".join(rows) + "\n"


def ply(vertices, faces, body=b""):
    head = f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\n"
    head += "property float x\nproperty float y\nproperty float z\n"
    return f"{head}element face {faces}\nproperty list uchar int vertex_indices\nend_header\n".encode() + body


def everything(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


@pytest.fixture
def kinetree(capsys, tmp_path, monkeypatch):
    """Runs the command in this process, in an empty folder: (exit code, what it printed, what it complained)."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(signal, "signal", lambda *_: None)  # the test's own process keeps its handlers
    monkeypatch.setattr(cli, "_leave", sys.exit)  # … and its life

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["kinetree", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.out + printed.err
        assert "\x1b" not in printed.out + printed.err
        return end.value.code, printed.out, printed.err

    return run


@pytest.fixture
def scans(tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    for t in range(3):
        (folder / f"{t}.off").write_text(off(V * (1 + t / 10)))
    return folder


@pytest.fixture
def refused(kinetree, tmp_path):
    """Runs into `out` up to the connectivity, expects exit code 2 with one message and nothing written; gives the message."""

    def run(*arguments):
        code, printed, complained = kinetree("run", *arguments, "-o", "out", "--until", "connectivity")
        assert (code, printed) == (2, "")
        assert complained.startswith("kinetree: ")
        assert complained.count("\n") == 1
        assert not (tmp_path / "out").exists()
        return complained.removeprefix("kinetree: ").rstrip("\n")

    return run


@pytest.fixture
def left_out(kinetree, scans, tmp_path):
    """Runs over three frames of which number 1 is bad and may be dropped: the others are done; gives the reason."""

    def run(name="1.off"):
        for until, ran, fresh in (("connectivity", 4, 0), ("sequence", 0, 1)):
            code, printed, complained = kinetree(
                "run", "-i", "scans", "-o", "out", "--until", until, "--set", "source.bad_share=0.4", "--executor", "sync", "-q"
            )
            assert (code, printed, complained) == (0, "", "")
            left = json.loads((tmp_path / "out" / "run.json").read_text())
            assert left["nodes"] == {"ran": ran, "fresh": fresh, "failed": 0, "skipped": 0}
        values = json.loads(kinetree("show", "sequence", "out", "--json")[1])["values"]
        assert values["frames"] == [0, 2]
        (bad,) = values["dropped"]
        assert bad["frame"] == 1
        return bad["reason"].removeprefix(f"{name}: ")

    return run


# ── where the sequence is ───────────────────────────────────────────────────────────────────────────────────────────


def test_missing_folder(refused, scans, tmp_path):
    assert refused("-i", "scnas") == f"{tmp_path / 'scnas'}: there is no such folder; there is {scans}"
    assert "the nearest folder that exists is" in refused("-i", "/nowhere/at/all")


def test_empty_folder(refused, tmp_path):
    (tmp_path / "empty").mkdir()
    assert refused("-i", "empty") == (
        f"{tmp_path / 'empty'}: no mesh among its files (nothing); .ply .obj .off .stl .glb .drc are read, one file a frame"
    )


def test_folder_without_meshes(refused, tmp_path):
    (tmp_path / "photos").mkdir()
    (tmp_path / "photos" / "1.jpg").write_bytes(b"")
    assert "images, but no folder for each camera; silhouettes are CAMERA/FRAME.png" in refused("-i", "photos")
    (tmp_path / "photos" / "1.jpg").rename(tmp_path / "photos" / "1.txt")
    assert "no mesh among its files (1 × .txt)" in refused("-i", "photos")


def test_mixed_formats(refused, scans):
    (scans / "3.obj").write_text("")
    message = refused("-i", "scans")
    assert message == f"{scans}: meshes of several formats (1 × .obj, 3 × .off); choose by a pattern such as {scans}/*.off"


def test_remedy_for_mixed_formats_works(kinetree, scans):
    (scans / "3.obj").write_text("")
    assert kinetree("run", "-i", f"{scans}/*.off", "-o", "out", "--until", "sequence", "-q") == (0, "", "")


def test_single_frame(refused, scans, tmp_path):
    message = "a single frame; kinematics are seen in motion, give at least two frames"
    assert refused("-i", "scans", "--frames", "1:2") == f"frames '1:2' selects {message}"
    for t in (1, 2):
        (scans / f"{t}.off").unlink()
    assert refused("-i", "scans") == f"{scans}: there is {message}"


def test_one_mesh_instead_of_a_folder(refused, scans):
    remedy = "give the folder of the frames' files, or a pattern such as *.off"
    assert refused("-i", "scans/0.off") == f"{scans / '0.off'}: one file, not a sequence; {remedy}"


@pytest.mark.parametrize(
    ("frames", "message"),
    [
        ("5", "frames '5': write start:stop or start:stop:step, e.g. 10:60:2"),
        ("a:b", "frames 'a:b': write start:stop or start:stop:step, e.g. 10:60:2"),
        ("1:2:3:4", "frames '1:2:3:4': write start:stop or start:stop:step, e.g. 10:60:2"),
        ("0:3:0", "frames '0:3:0': write start:stop or start:stop:step, e.g. 10:60:2"),
        ("3:0:-1", "frames '3:0:-1': the step must be positive; time runs forward"),
        ("7:9", "frames '7:9' selects none of the 3 frames of {scans}"),
        ("9" * 5000 + ":", "frames '9"),
        ("", "frames '': write start:stop"),
    ],
    ids=lambda text: text[:12],
)
def test_wrong_frames(refused, scans, frames, message):
    assert refused("-i", "scans", f"--frames={frames}").startswith(message.format(scans=scans))


def test_folder_that_may_not_be_entered(refused, scans, monkeypatch):
    is_file = Path.is_file

    def closed(path):
        if path.parent == scans:
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return is_file(path)

    monkeypatch.setattr(Path, "is_file", closed)
    assert refused("-i", "scans") == f"{scans}: cannot be read: Permission denied; check its name and its permissions"


def test_name_that_is_no_text(refused, kinetree, scans, tmp_path):
    broken = os.fsdecode(os.fsencode(scans) + b"/\xff.off")
    Path(broken).write_text(off())
    assert refused("-i", "scans").endswith("this name is not valid UTF-8; rename the file or folder")
    assert "\\udcff" in refused("-i", broken)


@pytest.mark.parametrize("name", ["a\0b", "x" * 5000, "/".join("x" * 3000), "~nobody-of-this-name/x", "s3://bucket/x", "-"])
def test_names_no_system_knows(refused, name):
    assert refused(f"--input={name}")


# ── frames that are none ────────────────────────────────────────────────────────────────────────────────────────────


def test_bad_frame_is_left_out_alone(left_out, scans):
    (scans / "1.off").write_text(off()[:40])
    assert "the file is cut short" in left_out()


def test_bad_frames_beyond_the_share_or_against_the_users_word_are_refused(refused, scans):
    (scans / "1.off").write_bytes(b"hello")
    reason = "frame 1: 1.off: does not begin with OFF"
    assert refused("-i", "scans").startswith(f"1 of 3 frames cannot be used (source.bad_share allows 0.2): {reason}")
    message = refused("-i", "scans", "--set", "source.bad_share=0.5", "--set", "source.on_bad_frame=fail")
    assert message.startswith(f"1 of 3 frames cannot be used (set source.on_bad_frame=drop to go on without them): {reason}")


def test_frame_made_whole_again_runs_with_the_frame_that_named_it(left_out, kinetree, scans, tmp_path):
    good = (scans / "1.off").read_bytes()
    (scans / "1.off").write_bytes(good[:40])
    left_out()
    (scans / "1.off").write_bytes(good)
    code, printed, _ = kinetree("run", "out", "--until", "connectivity", "--json")
    assert code == 0
    assert json.loads(printed)["nodes"] == {"ran": 4, "fresh": 1, "failed": 0, "skipped": 0}


def test_frame_that_cannot_be_opened_is_left_out_alone(left_out, scans, monkeypatch):
    read = Path.read_bytes
    open_ = Path.open

    def refuse(path, *rest, call):
        if path.name == "1.off":
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES), str(path))
        return call(path, *rest)

    monkeypatch.setattr(Path, "read_bytes", lambda path: refuse(path, call=read))
    monkeypatch.setattr(
        Path, "open", lambda path, *rest, **named: refuse(path, *rest, call=lambda p, *r: open_(p, *r, **named))
    )
    assert left_out() == "cannot be read: Permission denied; check its permissions"


@pytest.mark.parametrize("claim", [10**9, 2**31, 2**64, -1], ids=str)
def test_header_that_claims_more_than_the_file_holds(kinetree, tmp_path, claim):
    folder = tmp_path / "scans"
    folder.mkdir()
    body = V.astype("<f4").tobytes() + b"".join(struct.pack("<B3i", 3, *map(int, f)) for f in F)
    for t in range(3):
        (folder / f"{t}.ply").write_bytes(ply(4, 4, body))
    (folder / "1.ply").write_bytes(ply(claim, 4, body))
    code, _, complained = kinetree("run", "-i", "scans", "-o", "out", "--until", "mesh", "--executor", "sync", "-q")
    assert code == 2
    assert f"frame 1: 1.ply: its header claims {claim} × vertex in " in complained


# ── all frames in one file ──────────────────────────────────────────────────────────────────────────────────────────


class Bomb:
    """Leaves a file where it is unpickled."""

    def __reduce__(self):
        return (Path.touch, (Path("exploded"),))


def packed(**changes):
    arrays = {
        "vertices": np.concatenate([V, 2 * V]), "faces": F, "vertex_offsets": np.array([0, 4, 8]),
        "face_offsets": np.array([0, 4]), "fps": np.array(25.0), "unit": np.array("mm"),
    }  # fmt: skip
    return {name: a for name, a in {**arrays, **changes}.items() if a is not None}


def test_npz_with_pickled_objects_is_refused_and_not_unpickled(refused, tmp_path):
    file = tmp_path / "walk.npz"
    objects = np.empty(1, dtype=object)
    objects[0] = Bomb()
    np.savez(file, allow_pickle=True, **packed(vertices=objects))
    message = refused("-i", "walk.npz")
    assert message.startswith(f"{file}: cannot be read as .npz (ValueError: Object arrays cannot be loaded")
    assert message.endswith("an archive of plain arrays is needed")
    assert not (tmp_path / "exploded").exists()


@pytest.mark.parametrize(
    ("name", "content"),
    [("walk.npz", b""), ("walk.npz", b"PK\x03\x04"), ("walk.npz", b"hello"), ("walk.npz", pickle.dumps(Bomb()))],
)
def test_npz_that_is_none_is_refused(refused, tmp_path, name, content):
    (tmp_path / name).write_bytes(content)
    assert refused("-i", name).startswith(f"{tmp_path / name}: cannot be read as .npz (")
    assert not (tmp_path / "exploded").exists()


def test_npz_whose_members_point_outside_reads_and_writes_nothing_there(refused, tmp_path):
    with zipfile.ZipFile(tmp_path / "walk.npz", "w") as archive:
        data = io.BytesIO()
        np.save(data, V)
        archive.writestr("../../evil.npy", data.getvalue())
    assert "no array vertices, faces, vertex_offsets, face_offsets" in refused("-i", "walk.npz")
    assert sorted(p.name for p in tmp_path.iterdir()) == ["walk.npz"]


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"faces": None}, "no array faces; there are "),
        ({"vertices": V[:, :2]}, "vertices is float64 (4, 2); floating numbers (n, 3) are needed"),
        ({"vertex_offsets": np.array([0, 4, 9])}, "vertex_offsets run from 0 to 9, but there are 8 vertices"),
        ({"vertex_offsets": np.array([0, 8, 4])}, "vertex_offsets must increase, but 4 follows 8"),
        ({"vertex_offsets": np.array([0.0, 4.0])}, "vertex_offsets is float64 (2,); whole numbers (frame + 1,) are needed"),
        ({"fps": np.array(-1.0)}, "fps is -1.0; one positive number of frames a second is needed, or none"),
        ({"faces": F + 1}, "the file is damaged or its indices start at 1"),
        ({"vertices": np.full((8, 3), np.nan)}, "vertices are NaN or infinite"),
    ],
    ids=lambda changes: next(iter(changes)) if isinstance(changes, dict) else "",
)
def test_npz_of_a_wrong_layout_is_refused_by_its_array(refused, tmp_path, changes, words):
    np.savez(tmp_path / "walk.npz", **packed(**changes))
    message = refused("-i", "walk.npz")
    assert "walk.npz" in message
    assert words in message


@pytest.mark.parametrize("unit", ["it's", 'a "b" \\ c', "a\nb", "[red]", "None", "µm", "\x1b[31m"])
def test_unit_may_be_any_word(kinetree, tmp_path, unit):
    np.savez(tmp_path / "walk.npz", **packed(unit=np.array(unit)))
    assert kinetree("run", "-i", "walk.npz", "-o", "out", "--until", "sequence", "-q") == (0, "", "")
    assert kinetree("show", "sequence", "out")[0] == 0
    assert json.loads(kinetree("show", "sequence", "out", "--json")[1])["values"]["unit"] == unit


@pytest.mark.parametrize("content", ["", "{", '{"zarr_format": 2}', '{"zarr_format": 9, "node_type": "group"}', "[]"])
@pytest.mark.parametrize("marker", ["zarr.json", ".zgroup"])
def test_zarr_that_is_none_is_refused(refused, tmp_path, marker, content):
    folder = tmp_path / "walk.zarr"
    folder.mkdir()
    (folder / marker).write_text(content)
    message = refused("-i", "walk.zarr")
    assert message.startswith(f"{folder}: ")
    assert "not a readable zarr group" in message or "no array vertices" in message


# ── configuration ───────────────────────────────────────────────────────────────────────────────────────────────────


def test_typo_in_yaml_is_refused_with_the_nearest_key(refused, tmp_path):
    (tmp_path / "walk.yaml").write_text("source: {input: scans}\nmesh: {component_sahre: 0.1}\n")
    assert refused("walk.yaml") == "walk.yaml: mesh.component_sahre: no such key; did you mean 'component_share'?"
    (tmp_path / "walk.yaml").write_text("source: {input: scans}\nmehs: {component_share: 0.1}\n")
    assert refused("walk.yaml") == "walk.yaml: no such key 'mehs'; did you mean 'mesh'?"


def test_what_the_command_line_says_is_blamed_on_it_and_not_on_the_file(refused, tmp_path):
    (tmp_path / "walk.yaml").write_text("source: {input: scans}\n")
    message = refused("walk.yaml", "--set", "mesh.component_share=2")
    assert message == "--set mesh.component_share=2: mesh.component_share: input should be less than or equal to 1, got 2"


def test_yaml_that_would_run_code_is_refused_and_runs_none(refused, tmp_path):
    (tmp_path / "walk.yaml").write_text("source: {input: scans}\nmesh: !!python/object/apply:os.system [touch exploded]\n")
    assert refused("walk.yaml").startswith("walk.yaml, line 2: not valid YAML: could not determine a constructor for the tag")
    assert not (tmp_path / "exploded").exists()


@pytest.mark.parametrize("node", ["../../etc/passwd", "mesh[../../x]", "mesh/../../x", "mesh[frame=0]/../x"])
def test_names_of_nodes_lead_nowhere_else(kinetree, scans, node):
    (scans.parent / "w.yaml").write_text("source: {input: scans}")
    for command in ("why", "show"):
        code, _, complained = kinetree(command, node, "w.yaml")
        assert code == 2
        assert complained.startswith(f"kinetree: {node!r}")


@pytest.mark.parametrize("name", ["../x", "/etc/passwd", "mesh/../x", ""])
def test_names_of_tasks_and_methods_lead_nowhere_else(kinetree, scans, name):
    for arguments in (["--until", name], ["--force", name], ["--set", f"method={name or '/'}"]):
        code, _, complained = kinetree("run", "-i", "scans", "-o", "out", *arguments)
        assert code == 2
        assert "there are: " in complained or "did you mean " in complained
    assert not (scans.parent / "out").exists()


# ── names that are also orders to a terminal ────────────────────────────────────────────────────────────────────────

NASTY = [
    "[red]bold[",
    "a\nkinetree: done",
    "\x1b[2J\x1b[31mred",
    "<script>alert(1)</script>".replace("/", "_"),
    "\u202ereversed",
    "\x9b31m",
]


@pytest.mark.parametrize("name", NASTY, ids=ascii)
def test_names_of_files_are_printed_as_they_are_and_never_obeyed(kinetree, scans, tmp_path, name):
    for t in range(3):
        (scans / f"{t}.off").rename(scans / f"{t}{name}.off")
    (scans / f"1{name}.off").write_text("hello")
    folder = f"out{name}"
    to = ["-o", folder, "--set", "source.bad_share=0.4"]
    code, printed, complained = kinetree("run", "-i", "scans", *to, "--until", "sequence", "--executor", "sync")
    assert code == 0
    assert "frame 1" in printed + complained
    for text in (printed, complained):
        assert not set(text) & set("\x1b\x9b\u202e")
    if name.isprintable():
        assert f"1{name}.off: does not begin with OFF" in printed + complained
    for command in (["plan"], ["why", "mesh[2]"], ["show", "source[0]"], ["runs"], ["gc", "--dry-run"], ["graph"]):
        code, printed, complained = kinetree(*command, folder)
        assert (code, complained) == (0, "")
        assert not set(printed) & set("\x1b\x9b\u202e")


# ── stores ──────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_store_that_is_no_store(refused, scans, tmp_path):
    before = everything(scans)
    assert refused("-i", "scans", "--store", "scans") == (
        f"store {scans}: this folder holds other things and is no kinetree store; name an empty or a new one"
    )
    assert refused("-i", "scans", "--store", "scans/0.off").startswith(f"store {scans / '0.off'}: this is a file; ")
    assert everything(scans) == before
    assert refused("-i", "scans", "--store", "gs://bucket/x").endswith("which is not supported; give a folder")


def test_output_that_is_a_file(kinetree, scans, tmp_path):
    (tmp_path / "file").write_text("mine")
    code, _, complained = kinetree("run", "-i", "scans", "-o", "file", "--until", "mesh", "-q")
    assert code == 2
    assert complained == f"kinetree: output folder {tmp_path / 'file'}: this is a file; name another folder with --output\n"
    assert (tmp_path / "file").read_text() == "mine"


@pytest.fixture
def walked(kinetree, scans, tmp_path):
    code, _, complained = kinetree("run", "-i", "scans", "-o", "out", "--until", "mesh", "--executor", "sync", "-q")
    assert (code, complained) == (0, "")
    return tmp_path / "out"


def refuse_writes(monkeypatch, code):
    def refuse(path, data):
        raise OSError(code, os.strerror(code), str(path))

    monkeypatch.setattr(Path, "write_bytes", refuse)


@pytest.mark.parametrize(
    ("code", "words"),
    [
        (errno.ENOSPC, "no space left while writing"),
        (errno.EDQUOT, "no space left while writing"),
        (errno.EACCES, "Permission denied; check its permissions or name another folder (--output, --store)"),
        (errno.EROFS, "Read-only file system; check its permissions or name another folder (--output, --store)"),
    ],
)
@pytest.mark.parametrize("executor", ["sync", "threads"])
def test_disk_that_refuses_keeps_everything_stored(kinetree, walked, monkeypatch, code, words, executor):
    before = everything(walked / "store" / "artifacts") | everything(walked / "store" / "records")
    with monkeypatch.context() as patched:
        refuse_writes(patched, code)
        exit_code, _, complained = kinetree("run", "out", "--set", "mesh.merge=0", "--executor", executor, "-q")
    assert exit_code == 2
    assert words in complained
    assert complained.count("kinetree: ") == 1
    assert everything(walked / "store" / "artifacts") | everything(walked / "store" / "records") == before
    exit_code, printed, _ = kinetree("run", "out", "--until", "mesh")
    assert exit_code == 0
    assert printed.startswith("done: 0 ran, 3 fresh")


def test_disk_that_fills_up_in_the_middle_keeps_what_was_finished(kinetree, scans, tmp_path, monkeypatch):
    write = Path.write_bytes
    written = []

    def refuse(path, data):
        written.append(path)
        if len(written) > 7:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(path))
        return write(path, data)

    arguments = ("run", "-i", "scans", "-o", "out", "--until", "mesh", "--executor", "sync")
    with monkeypatch.context() as patched:
        patched.setattr(Path, "write_bytes", refuse)
        code, _, complained = kinetree(*arguments, "-q")
    assert code == 2
    assert "no space left while writing artifacts/" in complained or "no space left while writing run" in complained
    code, printed, _ = kinetree(*arguments, "--json")
    assert code == 0
    counts = json.loads(printed)["nodes"]
    assert counts["fresh"] == 1
    assert counts["ran"] == 2


def test_disk_that_is_truly_full(kinetree, scans, tmp_path):
    tiny = tmp_path / "tiny"
    tiny.mkdir()
    mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=28k", "none", str(tiny)], capture_output=True, text=True)
    if mounted.returncode:
        pytest.skip(f"a small disk cannot be mounted here: {mounted.stderr.strip()}")
    try:
        code, _, complained = kinetree("run", "-i", "scans", "-o", "tiny/out", "--until", "mesh", "--executor", "sync", "-q")
        assert code == 2
        assert "no space left while writing" in complained
        assert "nothing stored is lost: free some space and run again" in complained
        subprocess.run(["mount", "-o", "remount,size=4m", str(tiny)], check=True)
        code, printed, _ = kinetree("run", "-i", "scans", "-o", "tiny/out", "--until", "mesh", "--json")
        assert code == 0
        assert sum(json.loads(printed)["nodes"].values()) == 3
    finally:
        subprocess.run(["umount", str(tiny)], check=True)


def test_damaged_records_are_made_again(kinetree, walked):
    for path in (walked / "store" / "records").rglob("*.json"):
        path.write_text("{")
    code, printed, _ = kinetree("run", "out", "--until", "mesh", "--executor", "sync")
    assert code == 0
    assert printed.startswith("done: 3 ran")


def test_damaged_run_is_passed_over(kinetree, walked):
    (run,) = (walked / "store" / "runs").iterdir()
    run.write_text("{")
    for command in (["runs", "out"], ["gc", "out", "--dry-run"], ["plan", "out", "--set", "mesh.merge=0"]):
        assert kinetree(*command)[0] == 0
    code, _, complained = kinetree("diff", run.stem, run.stem, "out")
    assert code == 2
    assert f"runs/{run.name} is damaged; kinetree verify --repair removes it" in complained
    assert kinetree("run", "out", "--until", "mesh")[1].startswith("done: 0 ran, 3 fresh")


def test_store_whose_marker_is_damaged_is_refused(kinetree, walked):
    before = everything(walked / "store" / "artifacts")
    (walked / "store" / "kinetree-store.json").write_text("{")
    code, _, complained = kinetree("run", "out", "--until", "mesh")
    assert code == 2
    assert "its format is 'unreadable', this version reads 'kinetree.store/2'; name another folder with --store" in complained
    assert everything(walked / "store" / "artifacts") == before


# ── schedulers ──────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("address", "expected", "words"),
    [
        ("tcp://127.0.0.1:1", 3, "check the address"),
        ("gopher://127.0.0.1:1", 2, "unknown address scheme 'gopher'"),
        ("[red]", 2, "not an address"),
    ],
)
def test_scheduler_that_does_not_answer_is_to_be_tried_again_and_a_wrong_address_is_refused(
    kinetree, scans, monkeypatch, address, expected, words
):
    from kinetree.pipeline.running import clusters

    monkeypatch.setattr(clusters, "CONNECT_SECONDS", 0.2)
    code, _, complained = kinetree("run", "-i", "scans", "-o", "out", "--until", "mesh", "--scheduler", address, "-q")
    assert code == expected
    assert complained.startswith(f"kinetree: --scheduler {address}")
    assert words in complained
    code, printed, _ = kinetree("run", "out", "--until", "mesh", "--executor", "sync", "--json")
    assert (code, json.loads(printed)["nodes"]["ran"]) == (0, 3)


def test_scheduler_without_an_address(refused, scans):
    message = "compute.scheduler: string should have at least 1 character, got ''"
    assert refused("-i", "scans", "--scheduler", "") == message


def test_memory_that_is_no_size(kinetree, scans):
    code, _, complained = kinetree(
        "run", "-i", "scans", "-o", "out", "--until", "mesh", "--executor", "processes", "--set", "compute.memory=lots", "-q"
    )
    message = "--set compute.memory=lots: compute.memory: expected a size such as 4GB or 512MiB, got 'lots'"
    assert (code, complained) == (2, f"kinetree: {message}\n")
