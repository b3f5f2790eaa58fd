"""Texture coordinates, textures and colours of the input, for the files that show the reference mesh."""

from collections.abc import Mapping

import numpy as np

from kinetree.errors import KinetreeError
from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.appearance import Appearance, SurfaceMaterial
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.input.frames.appearance import appearance_of, has_own_file
from kinetree.tasks.input.frames.read import name
from kinetree.tasks.numerics.input.gltf_appearance import SurfaceAppearance
from kinetree.tasks.numerics.results.appearance import Seamed, seamed


@task()
def appearance(skeleton: Skeleton, source: Mapping[int, Source], mesh: Mapping[int, Mesh]) -> Appearance:
    """Reads what the frame looks like that the reference mesh is from, and keeps it on that mesh (ours).

    What cannot be had is said and left out: no run fails for a texture. Files in a bucket are not looked at: what a mesh names
    beside it is not brought from there.
    """
    frame = next((t for t in sorted(mesh) if _is_reference(mesh[t], skeleton)), None)
    if frame is None or not has_own_file(source[frame]):
        return Appearance.none()
    told = name(source[frame])
    try:
        found = appearance_of(source[frame])
        held = None if found is None else seamed(found, np.array(mesh[frame].vertex_of_input), np.array(mesh[frame].faces))
    except Exception as error:  # readers of other people's files raise anything
        reason = str(error) if isinstance(error, KinetreeError) else f"cannot be read ({type(error).__name__})"
        return Appearance.none((f"{told}: no texture and colours: {reason}",))
    missing = () if found is None else tuple(f"{told}: {text}" for text in found.missing)
    return _appearance(None if held is None else frame, found, held, missing)


def _is_reference(mesh: Mesh, skeleton: Skeleton) -> bool:
    """Whether the reference mesh is that of a frame."""
    same = mesh.faces.shape == skeleton.faces.shape and mesh.vertices.shape == skeleton.vertices.shape
    return bool(same and (mesh.faces == skeleton.faces).all() and (mesh.vertices == skeleton.vertices).all())


def _appearance(
    frame: int | None, found: SurfaceAppearance | None, held: Seamed | None, missing: tuple[str, ...]
) -> Appearance:
    """The artifact; empty where nothing is known."""
    if found is None or held is None:
        return Appearance.none(missing)
    n = len(held.vertex)
    return Appearance(
        frame=frame,
        vertex=held.vertex,
        faces=held.faces,
        has_uv=found.uv is not None,
        uv=np.zeros((n, 2)) if found.uv is None else held.uv,
        has_colour=found.colour is not None,
        colour=np.ones((n, 3)) if found.colour is None else held.colour,
        material=held.material,
        materials=tuple(SurfaceMaterial(name=m.name, colour=m.colour, picture=m.picture) for m in found.materials),
        media=tuple(shown.media for shown in found.pictures),
        sizes=tuple(len(shown.raw) for shown in found.pictures),
        content=np.frombuffer(b"".join(shown.raw for shown in found.pictures), np.uint8),
        missing=missing,
    )
