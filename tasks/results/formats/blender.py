"""A script for Blender that makes FBX of a GLB (ours).

FBX has no open specification, and no maintained Python package writes skinned, animated FBX without Autodesk's SDK. Blender
does.
"""

SCRIPT = '''"""Makes an .fbx and a .blend of every .glb in the folder of this file.

    blender --background --python to_fbx.py

or with any Python that has Blender as a module (pip install bpy):

    python to_fbx.py
"""

import os
from pathlib import Path

import bpy

try:
    import numpy
except ImportError:
    raise SystemExit("Blender's Python lacks numpy, which its import of glTF needs; on Debian: apt install python3-numpy")
if "bool" not in vars(numpy):
    numpy.bool = bool  # Blender 3.4 uses the old name, which numpy 1.24 to 1.26 do not have

FPS = @FPS@
here = Path(__file__).resolve().parent
for model in sorted(here.glob("*.glb")):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = max(1, round(FPS))
    scene.render.fps_base = scene.render.fps / FPS
    bpy.ops.import_scene.gltf(filepath=str(model))

    body = [o for o in bpy.data.objects if o.type == "ARMATURE" or any(m.type == "ARMATURE" for m in o.modifiers)]
    for other in [o for o in bpy.data.objects if o not in body]:
        bpy.data.objects.remove(other)  # the importer's picture of a bone
    begin, end = (round(x) for x in bpy.data.actions[0].frame_range)
    scene.frame_start, scene.frame_end = begin, end
    scene.frame_set(begin)
    bpy.ops.wm.save_as_mainfile(filepath=str(model.with_suffix(".blend")))
    bpy.ops.export_scene.fbx(
        filepath=str(model.with_suffix(".fbx")),
        object_types={"ARMATURE", "MESH"},
        apply_scale_options="FBX_SCALE_ALL",
        path_mode="COPY",
        embed_textures=True,
        add_leaf_bones=False,
        bake_anim_use_all_actions=False,
        bake_anim_use_nla_strips=False,
        bake_anim_simplify_factor=0.0,
    )
    print("wrote", model.with_suffix(".fbx"), flush=True)
if not bpy.app.binary_path:
    os._exit(0)  # the module bpy 4.2 crashes when Python takes it down after it read glTF
'''


def fbx_script(fps: float) -> str:
    """The script, for an animation of `fps` frames a second; it lies beside the GLB."""
    return SCRIPT.replace("@FPS@", repr(float(fps)))
