"""A page of a small body, from artifacts that are known to fit together."""

import numpy as np
from rigs import skinned, spider

from kinetree.schemas.alignment import Alignment
from kinetree.schemas.intervals import Intervals
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.mesh import Cleaning, Mesh
from kinetree.schemas.projection import Projection
from kinetree.schemas.skeleton import Skeleton
from kinetree.tasks.page.document import Page, Section, document, table
from kinetree.tasks.page.scene import Limits, Scene, scene


def playing(skeleton: Skeleton | None = None, limits: Limits | None = None) -> Scene:
    """The spider playing: every frame's own mesh is the aligned mesh in another order of vertices."""
    skeleton = skeleton or spider()
    frames, x = skeleton.frames, skinned(skeleton)
    order = np.random.default_rng(0).permutation(len(skeleton.vertices))
    back = np.argsort(order).astype(np.int32)
    face = np.array([np.flatnonzero((skeleton.faces == v).any(axis=1))[0] for v in order], np.int32)
    share = (skeleton.faces[face] == order[:, None]).astype(np.float64)
    count = len(order)
    return scene(
        skeleton,
        {f: Alignment(vertices=x[t], residual=np.zeros(count), stretch=np.ones(count), trust=np.ones(count), uncovered=0.0)
         for t, f in enumerate(frames)},
        {f: Projection(face=face, share=share, distance=np.zeros(count)) for f in frames},
        {f: Mesh(vertices=x[t][order], faces=back[skeleton.faces], vertex_of_input=np.arange(count, dtype=np.int32),
                 cleaning=Cleaning()) for t, f in enumerate(frames)},
        followed(skeleton),
        halves(frames),
        limits or Limits(),
    )


def followed(skeleton: Skeleton) -> Leaves:
    """Every end of a bone as a leaf; the first is not known in the second half."""
    tips = [j for j, kind in enumerate(skeleton.kinds) if kind == "leaf"]
    positions = skeleton.positions[:, tips].transpose(1, 0, 2).copy()
    positions[0, len(skeleton.frames) // 2 :] = np.nan
    none = np.zeros(0, np.int32)
    rows = np.zeros(positions.shape[:2], np.int32)
    kept = np.ones((2, len(tips)), np.bool_)
    return Leaves(
        frames=skeleton.frames, rows=rows, positions=positions, kept=kept, lost=none, lost_begin=none, lost_end=none
    )


def halves(frames: tuple[int, ...]) -> Intervals:
    """Two intervals."""
    cut = len(frames) // 2
    return Intervals(
        frames=frames, begin=np.array([0, cut]), end=np.array([cut - 1, len(frames) - 1]), z=np.zeros(len(frames) - 1),
        cues=(("leaves",),), strengths=np.zeros((1, len(frames) - 1)), cue_names=("correlation",), threshold=2.0,
    )  # fmt: skip


def page(title: str = "a walk", **more: object) -> str:
    """The whole page, what ran not yet told."""
    body = table(("joint", "turns"), [("arm", 50.5)])
    told = {"facts": [("frames", "12")], "warnings": [], "scene": playing(), "sections": [Section("s", "Joints", body)]}
    return document(Page(title=title, **{**told, **more}))  # type: ignore[arg-type]
