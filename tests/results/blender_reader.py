"""Runs Blender on a file, where it is installed, and says what it has: bones, their lengths, and the skinned mesh over time."""

import importlib.util
import json
import os
import shutil
import subprocess
import sys
from functools import cache
from pathlib import Path
from typing import Any

import pytest

LEAVE = """
import os
if not bpy.app.binary_path:
    os._exit(0)  # the module bpy 4.2 crashes when Python takes it down after some readers
"""
"""The end of a script."""
READ = """
import builtins, json, sys
from pathlib import Path
import bpy, numpy
if "bool" not in vars(numpy):
    numpy.bool = bool  # Blender 3.4 uses the old name
read = builtins.open
builtins.open = lambda file, mode="r", *rest, **named: read(file, mode.replace("U", ""), *rest, **named)  # and its BVH import
path, fps, frames, out = sys.argv[-4], float(sys.argv[-3]), json.loads(sys.argv[-2]), sys.argv[-1]
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = round(fps)
kind = Path(path).suffix
if kind == ".fbx":
    bpy.ops.import_scene.fbx(filepath=path, anim_offset=0.0)
elif kind == ".usda":
    if "usd_import" not in dir(bpy.ops.wm):
        Path(out).write_text("{}")
        sys.exit(0)
    bpy.ops.wm.usd_import(filepath=path)
elif kind == ".bvh":
    bpy.ops.import_anim.bvh(filepath=path, frame_start=0, axis_forward="-Z", axis_up="Y", global_scale=0.01)
else:
    bpy.ops.import_scene.gltf(filepath=path)
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
bodies = [o for o in bpy.data.objects if o.type == "MESH" and any(m.type == "ARMATURE" for m in o.modifiers)]
told = {"heads": [], "skin": [], "images": [[i.name, list(i.size)] for i in bpy.data.images if i.size[0]]}
told["fps"] = scene.render.fps / scene.render.fps_base
told["frames"] = [float(x) for x in bpy.data.actions[0].frame_range] if bpy.data.actions else []
told["matrices"] = {o.name: [list(row) for row in o.matrix_world] for o in (armature, *bodies)}
told["lengths"] = {b.name: b.length for b in armature.data.bones}
told["rest"] = {b.name: list(armature.matrix_world @ b.head_local) for b in armature.data.bones}
for body in bodies[:1]:
    mesh = body.data
    told["colours"] = {}
    for layer in mesh.color_attributes:
        held = {}
        corners = range(len(mesh.vertices)) if layer.domain == "POINT" else [loop.vertex_index for loop in mesh.loops]
        for v, value in zip(corners, layer.data):
            held[v] = list(value.color)
        told["colours"][layer.name] = [held.get(v) for v in range(len(mesh.vertices))]
    told["uv"] = [[list(d.uv) for d in layer.data] for layer in mesh.uv_layers]
    told["corners"] = [loop.vertex_index for loop in mesh.loops]
    told["materials"] = [
        [n.image.name for n in slot.material.node_tree.nodes if n.type == "TEX_IMAGE" and n.image]
        for slot in body.material_slots
        if slot.material and slot.material.node_tree
    ]
for frame in frames:
    scene.frame_set(frame)
    told["heads"].append({b.name: list(armature.matrix_world @ b.head) for b in armature.pose.bones})
    for body in bodies[:1]:
        skinned = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
        told["skin"].append([list(body.matrix_world @ v.co) for v in skinned.data.vertices])
Path(out).write_text(json.dumps(told))
"""
SECONDS = 120.0
"""Longest that Blender may take over a small body."""


@cache
def command() -> tuple[str, ...]:
    """What runs a script with Blender's modules; skips the test where nothing does."""
    module = os.environ.get("BLENDER_PYTHON") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if module is not None:
        return (module,)
    program = shutil.which("blender")
    if program is None:
        pytest.skip("no Blender: install the program, or pip install bpy, or let BLENDER_PYTHON name a Python that has it")
    whole = (program, "--background", "--factory-startup", "--python-exit-code", "3")
    tried = subprocess.run([*whole, "--python-expr", "import numpy"], capture_output=True, timeout=SECONDS, check=False)
    if tried.returncode != 0:
        pytest.skip("Blender's Python has no numpy, which its import of glTF needs (Debian: python3-numpy)")
    return (*whole, "--python")


def run(script: Path, *arguments: object) -> None:
    """Runs a script with Blender's modules."""
    last = [] if not arguments else ["--", *map(str, arguments)]
    full = [*command(), str(script), *last]
    done = subprocess.run(full, capture_output=True, text=True, timeout=SECONDS, check=False)
    assert done.returncode == 0, done.stderr[-2000:] + done.stdout[-2000:]


def opened(path: Path, fps: float, frames: list[int]) -> dict[str, Any]:
    """What Blender makes of a file: in its own coordinates, z up, metres."""
    script, told = path.with_name("read.py"), path.with_name("told.json")
    script.write_text(READ + LEAVE)
    run(script, path, fps, json.dumps(frames), told)
    found = dict(json.loads(told.read_text()))
    if not found:
        pytest.skip(
            f"this Blender was built without {path.suffix} (Debian's); pip install bpy, or BLENDER_PYTHON names its Python"
        )
    return found
