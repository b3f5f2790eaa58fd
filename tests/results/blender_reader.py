"""Runs Blender on a file, where it is installed, and says what it has: bones, their lengths, and the skinned mesh over time."""

import importlib.util
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

READ = """
import json, sys
from pathlib import Path
import bpy
path, fps, frames = sys.argv[1], float(sys.argv[2]), json.loads(sys.argv[3])
bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = round(fps)
kind = "fbx" if path.endswith(".fbx") else "gltf"
getattr(bpy.ops.import_scene, kind)(filepath=path, **({"anim_offset": 0.0} if kind == "fbx" else {}))
armature = next(o for o in bpy.data.objects if o.type == "ARMATURE")
body = next(o for o in bpy.data.objects if any(m.type == "ARMATURE" for m in o.modifiers))
told = {"scale": list(armature.matrix_world.to_scale()), "heads": [], "skin": []}
told["lengths"] = {b.name: b.length for b in armature.data.bones}
told["rest"] = {b.name: list(armature.matrix_world @ b.head_local) for b in armature.data.bones}
for frame in frames:
    bpy.context.scene.frame_set(frame)
    told["heads"].append({b.name: list(armature.matrix_world @ b.head) for b in armature.pose.bones})
    skinned = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
    told["skin"].append([list(body.matrix_world @ v.co) for v in skinned.data.vertices])
Path(sys.argv[4]).write_text(json.dumps(told))
"""


def python() -> str:
    """A Python that has Blender as a module; skips the test where there is none."""
    found = os.environ.get("BLENDER_PYTHON") or (sys.executable if importlib.util.find_spec("bpy") else None)
    if found is None:
        pytest.skip("pip install bpy brings Blender, or BLENDER_PYTHON names a Python that has it")
    return found


def run(script: Path, *arguments: object) -> None:
    """Runs a script with Blender's modules."""
    done = subprocess.run([python(), str(script), *map(str, arguments)], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr[-2000:] + done.stdout[-2000:]


def opened(path: Path, fps: float, frames: list[int]) -> dict[str, Any]:
    """What Blender makes of a file: in its own coordinates, z up, metres."""
    script, told = path.with_name("read.py"), path.with_name("told.json")
    script.write_text(READ)
    run(script, path, fps, json.dumps(frames), told)
    return dict(json.loads(told.read_text()))
