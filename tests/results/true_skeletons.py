"""Skeletons whose answers are known: the true one of a generated body, in the terms of a result."""

import json

import numpy as np

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.input.source import Source
from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.registration.projection import Projection
from kinetree.schemas.results.frame_truth import FrameTruth
from kinetree.schemas.results.known_truth import KnownTruth
from kinetree.schemas.results.truth import Truth
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.numerics.results.evaluation.tree_edit import contracted_tree, remaining_ancestors
from kinetree.tasks.results.frame_truth import frame_truth
from kinetree.tasks.results.known_truth import known_truth
from kinetree.tasks.results.truth import synthetic


def generated(figure: str = "human", frames: int = 6, vertices: int = 600, motion: str | None = None) -> str:
    """The recipe of a small body of fixed connectivity."""
    return recipe(SynthParams(figure=figure, frames=frames, vertices=vertices, connectivity="fixed", motion=motion))


def perfect(written: str) -> Skeleton:
    """The true skeleton as a run would leave it: root, joints that are scored, tips; the surface follows the true weights."""
    rig, truth = body(written), synthetic(written)
    tip = np.array([kind == "tip" for kind in truth.kinds])
    remains = np.array(truth.scored) | tip | (np.array(truth.parents) < 0)
    above = contracted_tree(truth.parents, list(remains))
    stay = np.flatnonzero(remains)
    carried = np.array(remaining_ancestors(truth.parents, list(remains)))
    W = np.zeros((len(rig.skin.V), len(stay)))
    np.add.at(W.T, np.searchsorted(stay, carried), rig.weights().T)
    influence = np.argsort(-W, axis=1, kind="stable")[:, :4]
    weight = np.take_along_axis(W, influence, axis=1)
    weight /= weight.sum(axis=1, keepdims=True)
    kinds = ["root" if p < 0 else "leaf" if tip[j] else "joint" for j, p in zip(stay, above, strict=True)]
    rotation = rig.G[:, [truth.parents[j] if tip[j] else j for j in stay]]
    label = np.where(W.max(axis=1) > 0.9, W.argmax(axis=1), -1)
    return Skeleton(
        frames=tuple(range(len(rig.X))),
        fps=rig.fps,
        unit=rig.figure.unit,
        names=tuple(truth.names[j] for j in stay),
        parents=tuple(above),
        kinds=tuple(kinds),
        positions=rig.X[:, stay],
        rotation=rotation,
        confidence=np.ones((len(rig.X), len(stay))),
        rest=np.array(rig.figure.rest)[stay],
        degrees=np.zeros(len(stay)),
        drift=np.zeros(len(stay)),
        support=np.full(len(stay), len(rig.X), np.int32),
        vertices=rig.skin.V,
        faces=rig.skin.F.astype(np.int32),
        label=label.astype(np.int32),
        influence=influence.astype(np.int32),
        weight=weight,
    )


def observed(written: str) -> tuple[dict[int, Source], dict[int, Mesh], dict[int, Projection]]:
    """What a run reads of the same body: every vertex of every frame lies on a corner of the reference mesh."""
    rig = body(written)
    F = rig.skin.F
    face, corner = np.zeros(len(rig.skin.V), np.int32), np.zeros(len(rig.skin.V), np.int64)
    for c in range(3):
        face[F[:, c]], corner[F[:, c]] = np.arange(len(F)), c
    same = np.arange(len(rig.skin.V), dtype=np.int32)
    where = Projection(face=face, share=np.eye(3)[corner], distance=np.zeros(len(same)))
    source = {t: Source(content=str(t), path="synth", part=t, kind="synth", recipe=written) for t in range(len(rig.X))}
    mesh = {
        t: Mesh(vertices=rig.frame(t)[0], faces=F.astype(np.int32), vertex_of_input=same, cleaning=Cleaning()) for t in source
    }
    return source, mesh, dict.fromkeys(source, where)


def held_against(
    skeleton: Skeleton, true: Truth, source: dict[int, Source], mesh: dict[int, Mesh], projection: dict[int, Projection]
) -> tuple[KnownTruth, dict[int, FrameTruth]]:
    """What an evaluation reads of a truth."""
    known = known_truth(true, source, Sequence(frames=tuple(source), fps=skeleton.fps, unit=skeleton.unit))
    of_frames = (({t: own[t]} if t in own else {} for own in (source, mesh, projection)) for t in known.compared)
    frames = zip(known.compared, of_frames, strict=True)
    return known, {t: frame_truth(skeleton, known, *artifacts, index=(t,)) for t, artifacts in frames}


def written_truth(written: str) -> str:
    """The truth.json of the same body."""
    return json.dumps(body(written).truth())
