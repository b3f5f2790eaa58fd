"""A small graph that ends in every export: a body whose rig is known in place of the analysis."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import trimesh
from results.rigged_bodies import skinned, spider

from kinetree.pipeline.graph import Graph
from kinetree.pipeline.task import task
from kinetree.schemas.array import Params
from kinetree.schemas.input.source import Source
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.input.frames.read import surface
from kinetree.tasks.input.hull import hull
from kinetree.tasks.input.isosurface import isosurface
from kinetree.tasks.input.mesh import mesh
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source
from kinetree.tasks.results.appearance import appearance
from kinetree.tasks.results.assumed_joints import assumed_joints
from kinetree.tasks.results.blender import blender
from kinetree.tasks.results.bvh import bvh
from kinetree.tasks.results.c3d import c3d
from kinetree.tasks.results.complete_skeleton import complete_skeleton
from kinetree.tasks.results.glb import glb
from kinetree.tasks.results.ply import ply
from kinetree.tasks.results.rignet import rignet
from kinetree.tasks.results.segmentation import segmentation
from kinetree.tasks.results.skeleton_json import skeleton_json
from kinetree.tasks.results.tables import tables
from kinetree.tasks.results.trc import trc
from kinetree.tasks.results.usd import usd
from kinetree.tasks.structure.error_bars import unknown_error_bars
from kinetree.tasks.structure.joint_names import joint_names


class SkeletonParams(Params):
    """What the body is called."""

    root: str = "trunk"
    """Name of the first joint."""
    fails: bool = False
    """Whether there is none."""


@task(over="frame")
def alignment(source: Source) -> Alignment:
    """The file's vertices, put back into the order of the reference mesh."""
    V, _ = surface(source)
    at = V[np.argsort(order(int(Path(source.path).stem)))]
    n = len(at)
    return Alignment(vertices=at, residual=np.zeros(n), stretch=np.ones(n), confidence=np.ones(n), uncovered=0.0)


@task(over="frame")
def projection(source: Source) -> Projection:
    """Every vertex of the file as the corner of a face of the reference mesh that it is; the first one was dropped."""
    turned = order(int(Path(source.path).stem))
    faces = spider().faces
    first = {int(v): (f, c) for f, row in reversed(list(enumerate(faces))) for c, v in enumerate(row)}
    indices = np.array([first[int(v)] for v in turned])
    share = np.eye(3)[indices[:, 1]]
    face = indices[:, 0].astype(np.int32)
    face[0], share[0] = -1, 0.0
    return Projection(face=face, share=share, distance=np.zeros(len(face)))


@task()
def skeleton(source: Mapping[int, Source], params: SkeletonParams) -> Skeleton:
    """The rig that moved the body."""
    if params.fails:
        raise ValueError("there is no body in it")
    names = spider().names
    return spider(names=(params.root, *names[1:]), frames=tuple(source))


@task()
def up_direction(skeleton: Skeleton) -> UpDirection:
    """That the body stands along its z."""
    return UpDirection(up="z", confidence=1.0)


def order(frame: int) -> np.ndarray:
    """(vertex,) which vertex of the reference mesh each vertex of a frame's file is."""
    return np.random.default_rng(frame).permutation(len(spider().vertices))


def write_frames(folder: Path) -> None:
    """The body as a person would have it: a file a frame, the vertices in another order in each."""
    body = spider()
    for frame, V in enumerate(skinned(body)):
        turned = order(frame)
        F = np.argsort(turned)[body.faces]
        trimesh.Trimesh(V[turned], F, process=False).export(folder / f"{frame:04d}.ply")


GRAPH = Graph.of(
    (
        source,
        hull,
        isosurface,
        mesh,
        alignment,
        projection,
        sequence,
        skeleton,
        complete_skeleton,
        up_direction,
        joint_names,
        unknown_error_bars,
        assumed_joints,
        appearance,
        glb,
        bvh,
        skeleton_json,
        segmentation,
        tables,
        rignet,
        ply,
        usd,
        blender,
        trc,
        c3d,
    )
)
