"""A skeleton as USD (UsdSkel), written by Pixar's library, which the extra `usd` installs (ours)."""

from functools import cache
from importlib import import_module
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import ConfigError
from kinetree.schemas.array import Floats
from kinetree.schemas.results.glb import ASSUMED_FPS
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.colours import linear, part_colours
from kinetree.tasks.results.formats.names import identifiers
from kinetree.tasks.results.formats.rig import local_offsets, local_rotations, quaternions, rest_frames


def usd(skeleton: Skeleton, up: str) -> bytes:
    """The reference mesh in metres bound to the animated joints, as the text of a .usda file.

    Time codes are source frame numbers. Lengths are metres: Blender 4.2 and others do not follow another metersPerUnit.

    up     : axis that points up: y or z
    raises : ConfigError where the extra is not installed
    """
    pxr = _pxr()
    stage = pxr.Usd.Stage.CreateInMemory(".usda")
    pxr.UsdGeom.SetStageUpAxis(stage, up.upper())
    pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetStartTimeCode(skeleton.frames[0])
    stage.SetEndTimeCode(skeleton.frames[-1])
    for rate in (stage.SetTimeCodesPerSecond, stage.SetFramesPerSecond):
        rate(skeleton.fps or ASSUMED_FPS)
    body = pxr.UsdSkel.Root.Define(stage, "/body")
    stage.SetDefaultPrim(body.GetPrim())
    bones = _skeleton(stage, skeleton)
    mesh = _mesh(stage, skeleton)
    binding = pxr.UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([bones.GetPath()])
    _weights(binding, skeleton)
    body.CreateExtentAttr(_points(_extent(skeleton)))
    text: str = stage.GetRootLayer().ExportToString()
    return text.encode()


@cache
def _pxr() -> Any:
    """The modules of the library, which have no types; raises ConfigError where it is not installed."""
    try:
        return SimpleNamespace(**{name: import_module(f"pxr.{name}") for name in ("Usd", "UsdGeom", "UsdSkel", "Vt")})
    except ImportError:
        raise ConfigError("USD needs a package that is not installed: pip install 'kinetree[usd]' brings it") from None


def _skeleton(stage: Any, skeleton: Skeleton) -> Any:
    """The joints with their animation: positions and rotations of each against its parent."""
    pxr = _pxr()
    B = rest_frames(skeleton.rest, skeleton.parents)
    offsets = local_offsets(skeleton.rest, B, skeleton.parents)
    rest_rotations = local_rotations(np.broadcast_to(np.eye(3), (1, *B.shape)), B, skeleton.parents)[0]
    bones = pxr.UsdSkel.Skeleton.Define(stage, "/body/skeleton")
    paths = pxr.Vt.TokenArray(_paths(skeleton))
    bones.CreateJointsAttr(paths)
    bones.CreateJointNamesAttr(pxr.Vt.TokenArray(list(skeleton.names)))
    bones.CreateBindTransformsAttr(_matrices(B, skeleton.rest))
    bones.CreateRestTransformsAttr(_matrices(rest_rotations, offsets))
    motion = pxr.UsdSkel.Animation.Define(stage, "/body/skeleton/motion")
    motion.CreateJointsAttr(paths)
    quaternion = quaternions(local_rotations(skeleton.rotation, B, skeleton.parents))
    rotations, translations = motion.CreateRotationsAttr(), motion.CreateTranslationsAttr()
    motion.CreateScalesAttr(pxr.Vt.Vec3hArray.FromNumpy(np.ones((len(B), 3), np.float16)))
    for t, frame in enumerate(skeleton.frames):
        rotations.Set(pxr.Vt.QuatfArray.FromNumpy(quaternion[t].astype(np.float32)), frame)
        translations.Set(_points(np.concatenate([skeleton.positions[t, :1], offsets[1:]])), frame)
    pxr.UsdSkel.BindingAPI.Apply(bones.GetPrim()).CreateAnimationSourceRel().SetTargets([motion.GetPath()])
    return bones


def _mesh(stage: Any, skeleton: Skeleton) -> Any:
    """The reference mesh with part colours."""
    pxr = _pxr()
    mesh = pxr.UsdGeom.Mesh.Define(stage, "/body/mesh")
    mesh.CreatePointsAttr(_points(skeleton.vertices))
    mesh.CreateFaceVertexCountsAttr(pxr.Vt.IntArray.FromNumpy(np.full(len(skeleton.faces), 3, np.int32)))
    mesh.CreateFaceVertexIndicesAttr(pxr.Vt.IntArray.FromNumpy(skeleton.faces.ravel()))
    mesh.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
    mesh.CreateExtentAttr(_points(np.stack([skeleton.vertices.min(axis=0), skeleton.vertices.max(axis=0)])))
    colours = linear(part_colours(skeleton.label, skeleton.faces))[skeleton.label]
    mesh.CreateDisplayColorPrimvar(pxr.UsdGeom.Tokens.vertex).Set(_points(colours))
    return mesh


def _weights(binding: Any, skeleton: Skeleton) -> None:
    """Adds the skinning weights to the binding of the mesh."""
    slots = skeleton.influence.shape[1]
    joints = np.where(skeleton.weight > 0, skeleton.influence, 0).astype(np.int32)
    binding.CreateJointIndicesPrimvar(False, slots).Set(_pxr().Vt.IntArray.FromNumpy(joints.ravel()))
    weights = skeleton.weight.astype(np.float32)
    binding.CreateJointWeightsPrimvar(False, slots).Set(_pxr().Vt.FloatArray.FromNumpy(weights.ravel()))
    binding.CreateGeomBindTransformAttr(_matrices(np.eye(3)[None], np.zeros((1, 3)))[0])


def _extent(skeleton: Skeleton) -> Floats:
    """(2, xyz) a box that contains the skin in all frames: all joints, and the largest distance of a vertex from its joints."""
    distance = np.linalg.norm(skeleton.vertices[:, None] - skeleton.rest[skeleton.influence], axis=2)
    reach = float(np.max(distance, where=skeleton.weight > 0, initial=0.0))
    X = skeleton.positions
    return np.stack([X.min(axis=(0, 1)) - reach, X.max(axis=(0, 1)) + reach])


def _paths(skeleton: Skeleton) -> list[str]:
    """The joints as paths, as UsdSkel requires: root/spine/…"""
    names = identifiers(skeleton.names)
    paths: list[str] = []
    for name, parent in zip(names, skeleton.parents, strict=True):
        paths.append(name if parent < 0 else f"{paths[parent]}/{name}")
    return paths


def _matrices(R: Floats, x: Floats) -> Any:
    """Transformations as USD has them: the rotation transposed, the translation in the last row."""
    M = np.tile(np.eye(4), (len(x), 1, 1))
    M[:, :3, :3] = R.transpose(0, 2, 1)
    M[:, 3, :3] = x
    return _pxr().Vt.Matrix4dArray.FromNumpy(M)


def _points(X: NDArray[Any]) -> Any:
    """Points as an array of the library."""
    return _pxr().Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(X, np.float32))
