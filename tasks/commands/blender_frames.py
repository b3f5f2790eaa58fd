"""What Blender runs to write every frame of a file as plain numbers; it knows nothing but Blender and Python's own library."""

SCRIPT = """import json
import os
import sys
from array import array
from pathlib import Path

import bpy

try:
    import numpy
    if "bool" not in vars(numpy):
        numpy.bool = bool  # Blender 3.4 uses the old name
except ImportError:
    pass  # only glTF needs it

source, target, most, rate = sys.argv[-4], Path(sys.argv[-3]), int(sys.argv[-2]), float(sys.argv[-1])
suffix = Path(source).suffix.lower()
readers = {
    ".fbx": (bpy.ops.import_scene, "fbx", {}),
    ".x3d": (bpy.ops.import_scene, "x3d", {}),
    ".dae": (bpy.ops.wm, "collada_import", {}),
    ".abc": (bpy.ops.wm, "alembic_import", {"set_frame_range": True, "always_add_cache_reader": True}),
}


def refuse(sentence):
    (target / "refused.txt").write_text(sentence)
    sys.exit(4)


bpy.context.preferences.filepaths.use_scripts_auto_execute = False
if suffix == ".blend":
    bpy.ops.wm.open_mainfile(filepath=source, load_ui=False, use_scripts=False)
else:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    group, name, more = readers[suffix]
    if name not in dir(group):
        version = bpy.app.version_string
        refuse(f"this Blender ({version}) was built without {suffix}; take one from blender.org, or pip install bpy")
    if suffix == ".abc":
        bpy.context.scene.render.fps = max(1, round(rate))
        bpy.context.scene.render.fps_base = bpy.context.scene.render.fps / rate
    getattr(group, name)(filepath=source, **more)

scene = bpy.context.scene
if suffix not in (".blend", ".abc") and bpy.data.actions:
    spans = [action.frame_range for action in bpy.data.actions]
    scene.frame_start, scene.frame_end = (round(f(span[k] for span in spans)) for f, k in ((min, 0), (max, 1)))
frames = range(scene.frame_start, scene.frame_end + 1, max(scene.frame_step, 1))
if len(frames) > most:
    refuse(f"has {len(frames)} frames, more than {most}")
shapes = {bone.custom_shape for o in scene.objects if o.type == "ARMATURE" for bone in o.pose.bones}
bodies = [o for o in scene.objects if o.type == "MESH" and o not in shapes and not o.hide_render]
counts = []
with (target / "vertices").open("wb") as vertices, (target / "faces").open("wb") as faces:
    for frame in frames:
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        begin = triangles = 0
        for body in bodies:
            shown = body.evaluated_get(graph)
            mesh = shown.to_mesh()
            mesh.calc_loop_triangles()
            mesh.transform(body.matrix_world)
            X, F = array("f", bytes(12 * len(mesh.vertices))), array("i", bytes(12 * len(mesh.loop_triangles)))
            mesh.vertices.foreach_get("co", X)
            mesh.loop_triangles.foreach_get("vertices", F)
            if body.matrix_world.determinant() < 0:
                F[1::3], F[2::3] = F[2::3], F[1::3]
            X.tofile(vertices)
            array("i", (v + begin for v in F)).tofile(faces)
            begin += len(mesh.vertices)
            triangles += len(mesh.loop_triangles)
            shown.to_mesh_clear()
        counts.append((begin, triangles))
layout = {"counts": counts, "fps": scene.render.fps / scene.render.fps_base, "scale": scene.unit_settings.scale_length}
(target / "layout.json").write_text(json.dumps(layout))
if not bpy.app.binary_path:
    os._exit(0)  # the module bpy 4.2 crashes when Python takes it down after some readers
"""
"""Arguments after --: the file, a folder for what is written, the most frames, frames a second of a file that is sampled."""
SUFFIXES = (".fbx", ".blend", ".abc", ".dae", ".x3d")
"""Files that it opens."""
SAMPLED = (".abc",)
"""Files of times, which have frames only at some rate."""
