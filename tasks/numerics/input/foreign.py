"""Files that people have and that are not read: what to do with each."""

_CONVERT = "is not read; kinetree convert makes a sequence of it where Blender is installed"
_EXPORT = "is not read; open it in Blender and export it as glTF binary (.glb) with its animation"
_CLOUD = "is a cloud of points; make a surface of every frame first (screened Poisson, in MeshLab or Open3D) and save it as PLY"
VOLUMETRIC_1 = (
    "is Universal Volumetric 1, whose frames are compressed by Corto or packed together, and is not read; unpack it to one PLY,"
    " GLB or Draco (.drc) file a frame; of version 2, name the manifest (.json)"
)
_NO_SURFACE = "holds {}, no surface; meshes, silhouettes or volumes are needed"
_FOREIGN = {
    **dict.fromkeys((".fbx", ".blend", ".dae", ".abc", ".x3d"), _CONVERT),
    ".3ds": _EXPORT,
    ".gltf": "may keep its data in other files, which are not opened; export it as one binary glTF (.glb)",
    **dict.fromkeys((".uvol", ".drcs", ".corto", ".crt"), VOLUMETRIC_1),
    **dict.fromkeys((".pcd", ".las", ".laz", ".xyz", ".pts", ".e57"), _CLOUD),
    **dict.fromkeys((".bvh", ".c3d", ".trc", ".amc", ".asf"), _NO_SURFACE.format("a skeleton or markers")),
    **dict.fromkeys((".mp4", ".mov", ".avi", ".mkv", ".webm"), _NO_SURFACE.format("pictures")),
    **dict.fromkeys((".gz", ".xz", ".bz2", ".zst", ".7z", ".rar", ".tar", ".tgz"), "is packed; unpack it, or zip the frames"),
    **dict.fromkeys((".vtk", ".vtp", ".vtu", ".ctm", ".3mf", ".wrl", ".msh"), "is not read; convert it to PLY"),
}


def advice(suffixes: set[str]) -> str:
    """What to do with files of other formats, a sentence for each suffix; empty where nothing is known of any."""
    return "".join(f"; {suffix} {_FOREIGN[suffix.lower()]}" for suffix in sorted(suffixes) if suffix.lower() in _FOREIGN)
