"""Files that Blender opens become sequences that a run reads; Blender is told to run nothing of them, and is ended in time."""

import importlib.util
import shutil
import stat
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from results.blender_reader import LEAVE, command
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.errors import ConfigError, InputError
from kinetree.pipeline import views
from kinetree.schemas.results.glb import GlbParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.commands.convert import convert
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.numerics.input.source import read_npz
from kinetree.tasks.results.blender import blender
from kinetree.tasks.results.glb import glb

TRAP = """
import sys
from pathlib import Path
import bpy
target = Path(sys.argv[-1])
text = bpy.data.texts.new("trap.py")
text.use_module = True
text.write(f"from pathlib import Path; Path({str(target.with_name('ran'))!r}).touch()")
cube = bpy.data.objects["Cube"]
driver = cube.driver_add("location", 0).driver
driver.expression = f"open({str(target.with_name('drove'))!r}, 'w') and 0"
bpy.context.scene.frame_end = 3
bpy.ops.wm.save_as_mainfile(filepath=str(target))
"""

EXPORTER = """
import sys
from pathlib import Path
import bpy
source = Path(sys.argv[-1])
if "alembic_export" not in dir(bpy.ops.wm):
    sys.exit(0)
bpy.ops.wm.open_mainfile(filepath=str(source))
body = next(o for o in bpy.data.objects if o.type == "MESH")
for name in ("fixed", "changing"):
    if name == "changing":
        coarse = body.modifiers.new("coarse", "DECIMATE")
        for frame, ratio in ((0, 0.9), (11, 0.4)):
            coarse.ratio = ratio
            coarse.keyframe_insert("ratio", frame=frame)
    bpy.ops.wm.save_as_mainfile(filepath=str(source.with_name(name + ".blend")))
    bpy.ops.wm.usd_export(filepath=str(source.with_name(name + ".usdc")), export_animation=True, export_armatures=False)
    bpy.ops.wm.alembic_export(filepath=str(source.with_name(name + ".abc")), start=0, end=11, as_background_job=False)
"""


def program(folder, text):
    """A stand-in for Blender."""
    path = folder / "blender"
    path.write_text(f"#!/bin/sh\n{text}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    return str(path)


@pytest.fixture
def file(tmp_path):
    (tmp_path / "walk.fbx").write_bytes(b"Kaydara")
    return tmp_path / "walk.fbx"


@pytest.fixture(scope="module")
def installed():
    """The command that runs a script with Blender's modules; its first word is what --blender names."""
    return command()


@pytest.fixture(scope="module")
def exported(installed, tmp_path_factory):
    """A folder with skeleton.fbx and skeleton.blend, made by the script of the export."""
    folder, body = tmp_path_factory.mktemp("exported"), spider()
    made = glb(body, plain(body), UpDirection(up="z", confidence=1.0), GlbParams())
    for name, data in views.files(blender(made, body), ()).items():
        (folder / name.removeprefix("blender/")).write_bytes(data)
    subprocess.run([*installed, str(folder / "to_fbx.py")], capture_output=True, check=True, timeout=120)
    return folder


def assert_is_spider(frames):
    """Pace, unit, faces and vertices are those of the body that was exported."""
    assert (len(frames), frames.fps, frames.unit) == (12, 10.0, "m")
    truth = skinned(spider()) / 1000
    size = np.ptp(truth[0], axis=0).max()
    for t in (0, 5, 11):
        V, F = frames.mesh(t)
        assert len(F) == len(spider().faces)
        np.testing.assert_allclose(V, truth[t], atol=2e-4 * size)


def test_fbx_that_was_exported_comes_back_as_the_sequence_that_it_was(installed, exported, tmp_path):
    convert(exported / "skeleton.fbx", tmp_path / "walk.npz", installed[0])
    assert_is_spider(read_npz(tmp_path / "walk.npz"))


def test_alembic_and_usd_of_blender_come_back_as_the_frames_that_they_were(installed, exported, tmp_path):
    (tmp_path / "exporter.py").write_text(EXPORTER + LEAVE)
    subprocess.run([*installed, str(tmp_path / "exporter.py"), "--", str(exported / "skeleton.blend")], check=True, timeout=120)
    if not (exported / "changing.abc").exists():
        pytest.skip("this Blender was built without Alembic (Debian's); pip install bpy, or BLENDER_PYTHON names its Python")
    counts = {}
    for name in ("fixed", "changing"):
        convert(exported / f"{name}.abc", tmp_path / f"{name}-abc.npz", installed[0], fps=10.0)
        convert(exported / f"{name}.blend", tmp_path / f"{name}.npz", installed[0])
        sequences = [read_npz(tmp_path / f"{name}-abc.npz"), read_npz(tmp_path / f"{name}.npz")]
        if importlib.util.find_spec("pxr"):
            sequences.append(read_animated(exported / f"{name}.usdc"))
        if name == "fixed":
            for frames in sequences:
                assert_is_spider(frames)
        for t in range(12):
            V, F = sequences[0].mesh(t)
            counts[name, t] = len(V)
            for frames in sequences[1:]:
                np.testing.assert_allclose(frames.mesh(t)[0], V, atol=1e-6)
                assert len(frames.mesh(t)[1]) == len(F)
    assert counts["changing", 0] > counts["changing", 5] > counts["changing", 11]


def test_only_files_of_times_are_sampled_at_a_rate(file):
    with pytest.raises(ConfigError, match=r"--fps 30: \.fbx has frames of its own"):
        convert(file, fps=30.0)


def test_nothing_in_a_blender_file_runs(installed, tmp_path):
    (tmp_path / "trap_maker.py").write_text(TRAP + LEAVE)
    subprocess.run([*installed, str(tmp_path / "trap_maker.py"), "--", str(tmp_path / "trap.blend")], check=True, timeout=120)
    for name in ("ran", "drove"):
        (tmp_path / name).unlink(missing_ok=True)
    convert(tmp_path / "trap.blend", tmp_path / "trap.npz", installed[0])
    assert len(read_npz(tmp_path / "trap.npz")) == 3
    assert not (tmp_path / "ran").exists()
    assert not (tmp_path / "drove").exists()


def test_damaged_file_is_refused_in_words(installed, file):
    with pytest.raises(InputError, match=r"walk\.fbx: Blender cannot open it \((?!.*frames\.py)"):
        convert(file, None, installed[0])
    assert not file.with_suffix(".npz").exists()


def test_without_blender_it_says_what_to_do(file):
    with pytest.raises(ConfigError, match=r"Blender, which is not installed here \(no-such-program\); install it \(or pip"):
        convert(file, None, "no-such-program")


def test_blender_that_does_not_finish_is_ended_with_all_that_it_began(file, tmp_path):
    slow = program(tmp_path, f"(sleep 30; touch {tmp_path}/later) & sleep 30")
    began = time.monotonic()
    with pytest.raises(InputError, match="did not finish within 1 s"):
        convert(file, None, slow, seconds=1.0)
    assert time.monotonic() - began < 25


def test_blender_is_told_to_run_nothing_of_the_file(file, tmp_path):
    recorder = program(tmp_path, f'echo "$@" > {tmp_path}/arguments; exit 1')
    with pytest.raises(InputError, match=r"cannot open it \(exit code 1\)"):
        convert(file, None, recorder)
    arguments = (tmp_path / "arguments").read_text().split()
    assert arguments.index("--disable-autoexec") < arguments.index("--python")
    assert "--factory-startup" in arguments


def test_python_that_has_blender_as_a_module_runs_the_script_itself(file, tmp_path, monkeypatch):
    recorder = tmp_path / "python3.11"
    Path(program(tmp_path, f'echo "$@" > {tmp_path}/arguments; exit 1')).rename(recorder)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(InputError, match=r"cannot open it \(exit code 1\)"):
        convert(file, None, "./python3.11")
    arguments = (tmp_path / "arguments").read_text().split()
    assert arguments[0].endswith("frames.py")
    assert arguments[1:3] == ["--", str(file)]


def test_files_that_are_there_and_other_formats_are_refused(file, tmp_path):
    file.with_suffix(".npz").touch()
    with pytest.raises(ConfigError, match="already there"):
        convert(file)
    (tmp_path / "walk.glb").touch()
    with pytest.raises(ConfigError, match=r"\.glb is not converted"):
        convert(tmp_path / "walk.glb")
    with pytest.raises(InputError, match="no such file"):
        convert(tmp_path / "run.fbx")
    with pytest.raises(ConfigError, match="ends in"):
        convert(file, tmp_path / "walk.zip")


def leaving(folder, layout, vertices=72, faces=24):
    """A stand-in for Blender that leaves two frames of a triangle, in so many bytes; None leaves no such file."""
    sizes = {"vertices": vertices, "faces": faces}
    zeros = [f"head -c {size} /dev/zero > {name}" for name, size in sizes.items() if size is not None]
    there = r'while [ "$1" != -- ]; do shift; done; cd "$3"'
    return program(folder, "; ".join([there, *zeros, f"printf '%s' '{layout}' > layout.json"]))


def test_what_is_left_by_blender_is_checked(file, tmp_path):
    counts, rest = '"counts": [[3, 1], [3, 1]]', '"scale": 1, "fps": 24'
    for layout, words in (
        ("nonsense", "what Blender says: not JSON"),
        (f'{{{counts}, "scale": NaN, "fps": 24}}', "a unit of nan m; set both in Blender"),
        (f'{{{counts}, "scale": 1, "fps": 0}}', "its scene has 0 frames a second"),
        (f'{{{counts}, "scale": 1}}', "counts, scale and fps are needed"),
        (f'{{{counts}, "scale": 1, "fps": "fast"}}', "counts, scale and fps are needed"),
        ("[]", "counts, scale and fps are needed"),
        (f'{{"counts": [[3, 1], [3]], {rest}}}', "counts, scale and fps are needed"),
        (f'{{"counts": [[3, 1], [{10**30}, 1]], {rest}}}', "counts, scale and fps are needed"),
        (f'{{"counts": [[-3, 1], [9, 1]], {rest}}}', "no surface in some frames"),
    ):
        with pytest.raises(InputError, match=words):
            convert(file, None, leaving(tmp_path, layout))
    assert not file.with_suffix(".npz").exists()


@pytest.mark.parametrize(("vertices", "faces"), [(60, 24), (64, 24), (73, 24), (72, 12), (72, 20), (None, 24), (72, None)])
def test_numbers_that_blender_could_not_write_whole_are_refused(file, tmp_path, vertices, faces):
    left = rf"left {vertices or 0} bytes of vertices and {faces or 0} of faces, not 72 and 24; is the disk of .* full"
    with pytest.raises(InputError, match=left):
        convert(file, None, leaving(tmp_path, '{"counts": [[3, 1], [3, 1]], "scale": 1, "fps": 24}', vertices, faces))
    assert not file.with_suffix(".npz").exists()


def test_what_is_left_whole_becomes_a_sequence(file, tmp_path):
    convert(file, None, leaving(tmp_path, '{"counts": [[3, 1], [3, 1]], "scale": 1, "fps": 24}'))
    assert len(read_npz(file.with_suffix(".npz"))) == 2


def test_nothing_is_written_over_or_begun_in_vain(file, tmp_path):
    never = program(tmp_path, f"touch {tmp_path}/began")
    (tmp_path / "link.npz").symlink_to("nowhere")
    for target, words in (
        (tmp_path / "link.npz", "already there"),
        (tmp_path / "no" / "x.npz", "there is no folder .*/no; make"),
    ):
        with pytest.raises(ConfigError, match=words):
            convert(file, tmp_path / target, never)
    with pytest.raises(InputError, match="not a file"):
        convert(Path(shutil.copytree(tmp_path, tmp_path.with_name("folder.fbx"), symlinks=True)), tmp_path / "x.npz", never)
    assert not (tmp_path / "began").exists()
    meanwhile = leaving(tmp_path, '{"counts": [[3, 1], [3, 1]], "scale": 1, "fps": 24}')
    Path(meanwhile).write_text(Path(meanwhile).read_text() + f"\necho mine > {file.with_suffix('.npz')}\n")
    with pytest.raises(ConfigError, match="already there"):
        convert(file, None, meanwhile)
    assert file.with_suffix(".npz").read_text() == "mine\n"
