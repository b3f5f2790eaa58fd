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
    file_name = name(source[frame])
    try:
        surface = appearance_of(source[frame])
        own = mesh[frame]
        corners = None if surface is None else seamed(surface, np.array(own.vertex_of_input), np.array(own.faces))
        missing = () if surface is None else tuple(f"{file_name}: {text}" for text in surface.missing)
        return _appearance(None if corners is None else frame, surface, corners, missing)
    except Exception as error:  # readers of other people's files raise anything
        reason = str(error) if isinstance(error, KinetreeError) else f"cannot be read ({type(error).__name__})"
        return Appearance.none((f"{file_name}: no texture and colours: {reason}",))


def _is_reference(mesh: Mesh, skeleton: Skeleton) -> bool:
    """Whether the reference mesh is that of a frame."""
    same = mesh.faces.shape == skeleton.faces.shape and mesh.vertices.shape == skeleton.vertices.shape
    return bool(same and (mesh.faces == skeleton.faces).all() and (mesh.vertices == skeleton.vertices).all())


def _appearance(
    frame: int | None, surface: SurfaceAppearance | None, corners: Seamed | None, missing: tuple[str, ...]
) -> Appearance:
    """The artifact; empty where nothing is known."""
    if surface is None or corners is None:
        return Appearance.none(missing)
    n = len(corners.vertex)
    return Appearance(
        frame=frame,
        vertex=corners.vertex,
        faces=corners.faces,
        has_uv=surface.uv is not None,
        uv=np.zeros((n, 2)) if surface.uv is None else corners.uv,
        has_colour=surface.colour is not None,
        colour=np.ones((n, 3)) if surface.colour is None else corners.colour,
        material=corners.material,
        materials=tuple(SurfaceMaterial(name=m.name, colour=m.colour, picture=m.picture) for m in surface.materials),
        media=tuple(picture.media for picture in surface.pictures),
        sizes=tuple(len(picture.raw) for picture in surface.pictures),
        content=np.frombuffer(b"".join(picture.raw for picture in surface.pictures), np.uint8),
        missing=missing,
    )
