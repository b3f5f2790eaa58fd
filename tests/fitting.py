"""An articulated body with three arms, its frames surfaced with other vertices, and what a fit is given of it."""

import numpy as np
import numpy.typing as npt
import trimesh
from articulated import Known, swings, three_arms
from limbs import rotation

from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody, surface

Floats = npt.NDArray[np.float64]
FRAMES = 16
FIRST = 10
SPOILT = (6, 7)


def arms(degrees: float = 30.0) -> tuple[Known, SkinnedBody]:
    """The body in motion; arm k is part k, the middle is part 0."""
    known = three_arms(swings(FRAMES, 4, degrees))
    bound, weight = np.zeros((len(known.V), 4), np.int64), np.zeros((len(known.V), 4))
    bound[:, 0], weight[:, 0] = known.label, 1.0
    return known, SkinnedBody.of(known.V, known.F, bound, weight, known.joints, known.parents)


def true(known: Known, frame: int) -> FramePose:
    """The pose that a frame was made with."""
    return FramePose(known.R[frame].copy(), known.R[frame, 0] @ known.joints[0] + known.t[frame, 0])


def surface_at(known: Known, body: SkinnedBody, frame: int, lost: int = -1) -> Target:
    """A frame's surface with other vertices, one arm cut off where that is asked."""
    V, F = trimesh.remesh.subdivide(known.x[frame], known.F[(known.label[known.F] != lost).all(axis=1)])
    order = np.random.default_rng(frame).permutation(len(V))
    return Target.of(V[order], np.argsort(order)[F], body.size)


def turned(at: FramePose, part: int, turn: Floats) -> FramePose:
    """The same with one part turned otherwise."""
    R = at.R.copy()
    R[part] = turn @ R[part]
    return FramePose(R, at.x)


def tip(body: SkinnedBody, at: FramePose, part: int) -> Floats:
    """Where the middle of a part's far half is: how it turns about itself, which a round arm does not show, moves nothing."""
    mine = np.flatnonzero(body.label == part)
    far = mine[np.argsort(np.linalg.norm(body.V[mine] - body.rest[part], axis=1))[len(mine) // 2 :]]
    middle: Floats = surface(body, at)[0][far].mean(axis=0)
    return middle


def articulation(known: Known, uncertain: tuple[int, ...] = SPOILT) -> KinematicTree:
    """Root, three arms and the end of the first, whose pose is off in some frames."""
    R, confidence = known.R[:, [0, 1, 1, 2, 3]].copy(), np.ones((FRAMES, 5))
    for t in uncertain:
        R[t, 1:3] = rotation((0.0, 0.0, 1.0), 0.7) @ R[t, 1:3]
        confidence[t, 1:3] = 0.1
    parents, rest = (-1, 0, 1, 0, 0), np.stack([*known.joints[:2], 2 * known.joints[1], *known.joints[2:]])
    X = np.empty((FRAMES, 5, 3))
    X[:, 0] = known.R[:, 0] @ rest[0] + known.t[:, 0]
    for j in range(1, 5):
        X[:, j] = X[:, parents[j]] + np.einsum("txy,y->tx", R[:, parents[j]], rest[j] - rest[parents[j]])
    own = np.array([0, 1, 3, 4])[known.label]
    return KinematicTree(
        frames=tuple(range(FIRST, FIRST + FRAMES)), names=("root", "a", "a_end", "b", "c"),
        parents=parents, kinds=("root", "joint", "leaf", "joint", "joint"), positions=X, rotation=R, confidence=confidence,
        rest=rest, degrees=np.zeros(5), drift=np.zeros(5), support=np.zeros(5, int), vertices=known.V, faces=known.F, label=own,
        influence=np.stack([own, *np.zeros((3, len(own)), int)], axis=1), weight=np.tile(np.eye(4)[0], (len(own), 1)),
        uncertain=np.isin(np.arange(FRAMES), uncertain), pair=np.zeros((0, 2), int), centre=np.zeros((0, 3)),
        part=own, border_drift=np.zeros(0), border_degrees=np.zeros(0), joint_of_part=np.array([0, 1, 3, 4]), dropped=(),
        free_length=np.zeros(5), free_deviation=np.zeros(5), spread=np.full(5, np.nan), agreeing=np.zeros(5, int),
        joint_residual=np.zeros(5), surface_offset=np.full(5, np.nan), hinge_offset=np.full(5, np.nan),
        border_radius=np.full(5, np.nan), partner=np.full(5, -1),
    )  # fmt: skip
