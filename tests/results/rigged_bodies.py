"""Skeletons whose answers are known: synthetic bodies with the rig that moved them, and what skinning them gives."""

from functools import cache

import numpy as np
import numpy.typing as npt

from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.motion import turning_angles

Floats = npt.NDArray[np.float64]

SPIDER = {
    "name": "spider",
    "unit": "mm",
    "joints": [
        {"name": "trunk", "position": [3, 1, 0], "radius": 1.2},
        {"name": "arm", "parent": "trunk", "position": [7, 1, 0], "radius": 0.9},
        {"name": "hand", "parent": "arm", "position": [11, 2, 0], "radius": 0.6},
        {"name": "tail", "parent": "trunk", "position": [0, -5, 1], "radius": 0.7},
        {"name": "knee", "parent": "trunk", "position": [0, 1, 5], "radius": 0.8},
        {"name": "foot", "parent": "knee", "position": [0, 0, 9], "radius": 0.6},
        {"name": "spur", "parent": "knee", "position": [3, 3, 6], "radius": 0.4},
    ],
    "motions": {
        "crawl": {
            "trunk": [
                {"axis": [0, 0, 1], "amplitude": 170, "frequency": 0.6},
                {"axis": [1, 0, 0], "amplitude": 2, "slides": True},
            ],
            "arm": [{"axis": [0, 0, 1], "amplitude": 50}, {"axis": [1, 0, 0], "amplitude": 90, "phase": 0.2}],
            "knee": [{"axis": [1, 0, 0], "amplitude": 70, "offset": 30, "phase": 0.1}],
        }
    },
}
"""A joint in a chain, a leaf beside joints, and a joint with two leaves; the trunk turns by more than half a turn."""


def spider(**changes: object) -> Skeleton:
    """A small body with its skeleton; `changes` replace fields."""
    return skeleton_of(_spider(), **changes)


@cache
def _spider() -> Body:
    return Body.of(Figure.of(SPIDER), frames=12, fps=10.0, vertices=500, connectivity="fixed")


def skeleton_of(body: Body, **changes: object) -> Skeleton:
    """The rig of a synthetic body as a skeleton: its joints and weights, its rest pose as the reference mesh."""
    figure, parents = body.figure, body.figure.parents
    leaf = np.array([j not in parents for j in range(len(parents))])
    R = np.where(leaf[None, :, None, None], body.G[:, np.maximum(parents, 0)], body.G)
    W = body.weights()
    influence = np.argsort(-W, axis=1, kind="stable")[:, :4]
    weight = np.take_along_axis(W, influence, axis=1)
    weight /= weight.sum(axis=1, keepdims=True)
    degrees = np.where(leaf | (parents < 0), 0.0, turning_angles(body.R))
    kinds = ["root" if p < 0 else "leaf" if end else "joint" for p, end in zip(parents, leaf, strict=True)]
    fields = {
        "frames": tuple(range(len(body.X))),
        "fps": body.fps,
        "unit": figure.unit,
        "names": tuple(figure.names),
        "parents": tuple(parents.tolist()),
        "kinds": tuple(kinds),
        "positions": body.X,
        "rotation": R,
        "confidence": np.full(body.X.shape[:2], 0.75),
        "rest": figure.rest,
        "degrees": degrees,
        "drift": np.full(len(parents), 0.01),
        "support": np.full(len(parents), len(body.X)),
        "vertices": body.skin.V,
        "faces": body.skin.F.astype(np.int32),
        "label": np.where(weight[:, 0] > 0.8, influence[:, 0], -1).astype(np.int32),
        "influence": influence.astype(np.int32),
        "weight": weight,
    }
    return Skeleton.model_validate({**fields, **changes})


def without_joint(skeleton: Skeleton, name: str) -> Skeleton:
    """The same body in which a joint that never turns was not found: what it carries follows its parent."""
    gone = skeleton.names.index(name)
    stay = [j for j in range(len(skeleton.names)) if j != gone]
    above = [skeleton.parents[gone] if j == gone else j for j in range(len(skeleton.names))]
    number = np.array([stay.index(j) for j in above])
    arrays = {
        "positions": skeleton.positions[:, stay], "rotation": skeleton.rotation[:, stay],
        "confidence": skeleton.confidence[:, stay], "label": np.where(skeleton.label < 0, -1, number[skeleton.label]),
        **{each: np.asarray(getattr(skeleton, each))[stay] for each in ("rest", "degrees", "drift", "support")},
        "influence": number[skeleton.influence].astype(np.int32),
    }  # fmt: skip
    lists = {each: tuple(getattr(skeleton, each)[j] for j in stay) for each in ("names", "kinds")}
    parents = tuple(int(number[p]) if p >= 0 else -1 for p in (skeleton.parents[j] for j in stay))
    arrays["label"] = arrays["label"].astype(np.int32)
    fields = {each: getattr(skeleton, each) for each in Skeleton.model_fields}
    return Skeleton.model_validate({**fields, **arrays, **lists, "parents": parents})


def skinned(skeleton: Skeleton) -> Floats:
    """(frame, vertex, xyz) the surface as the skeleton's own docstring says: Σ_i w_vi [R_i(t) (v − rest_i) + x_i(t)]."""
    out = np.zeros((len(skeleton.frames), *skeleton.vertices.shape))
    for slot in range(skeleton.influence.shape[1]):
        i = skeleton.influence[:, slot]
        v = skeleton.vertices - skeleton.rest[i]
        moved = np.einsum("tvxy,vy->tvx", skeleton.rotation[:, i], v) + skeleton.positions[:, i]
        out += skeleton.weight[:, slot, None] * moved
    return out


def bars_of(skeleton: Skeleton) -> ErrorBars:
    """Expected errors of a hundredth of the unit times the joint's number; a half more in the first frame."""
    turning = np.array([kind == "joint" for kind in skeleton.kinds])
    expected = np.where(turning, 0.01 * (1 + np.arange(len(turning))), np.nan)
    in_frame = np.tile(expected, (len(skeleton.frames), 1))
    in_frame[0] *= 1.5
    count = np.where(turning, 3, 0)
    return ErrorBars(
        joints=skeleton.names, frames=skeleton.frames, cuts=4, expected=expected, bound=2.0 * expected, in_frame=in_frame,
        drift=expected, spread=0.5 * expected, residual=0.2 * expected, surface_offset=0.3 * expected,
        turning_resistance=expected, hinge_offset=expected, turning_below=expected, softness=expected,
        asymmetry=0.4 * expected, agreeing=count, support=4 * count,
        evidence=tuple("motion" if each else None for each in turning),
    )  # fmt: skip
