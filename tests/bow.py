"""A pipe that bows: two legs that move alike and the pelvis between them are one part, before frames in which it turns."""

from collections.abc import Callable

import numpy as np
from limbs import rotation
from shapes import y_pipe

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.geometry.geodesic_distance import geodesic_distance
from kinetree.tasks.numerics.geometry.surface import Surface, surface_areas
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.first_tree import FirstTree, PartGraph
from kinetree.tasks.numerics.structure.limb_pairs import LimbPairs
from kinetree.tasks.numerics.structure.part_tree import MovingSurface

V, F, _ = y_pipe()
"""A trunk along x from the fork at 0, and two legs at 60° on either side of −x, all 24 long and up to 4 wide."""
HIP, KNEE, SPINE = 6.0, 14.0, 8.0
"""Distance of hips and knees from the fork along the legs, and of the spine's joint along the trunk."""
LEGS = np.array([[-0.5, np.sqrt(0.75), 0.0], [-0.5, -np.sqrt(0.75), 0.0]])
TIPS = (V @ LEGS.T).argmax(axis=0)
FRAMES = 24
TRUNK, PELVIS, SHANKS = 0, 1, (2, 3)
"""Parts that are found; the pelvis has both thighs."""


def pairs() -> LimbPairs:
    """Both legs; twice, since a single pair of limbs says nothing of a body."""
    return LimbPairs(np.stack([TIPS, TIPS]), np.stack(2 * [geodesic_distance(Surface.of(V, F), TIPS)]))


def motions(of_pelvis: float) -> tuple[Floats, Floats]:
    """(frame, part, 3, 3), (frame, part, xyz) of trunk, pelvis, thighs and shanks; the pelvis turns by so many degrees."""
    wave = np.sin(2 * np.pi * np.arange(FRAMES) / 12.0)
    R, t = np.tile(np.eye(3), (FRAMES, 6, 1, 1)), np.zeros((FRAMES, 6, 3))
    for f in range(FRAMES):
        pelvis = rotation((0.0, 1.0, 0.0), np.radians(of_pelvis) * wave[f])
        hips, spine = HIP * LEGS.mean(axis=0), np.array([SPINE, 0.0, 0.0])
        R[f, 1], t[f, 1] = pelvis, hips - pelvis @ hips
        R[f, 0] = pelvis @ rotation((0.0, 1.0, 0.0), np.radians(20.0) * wave[f - 3])
        t[f, 0] = pelvis @ spine + t[f, 1] - R[f, 0] @ spine
        for k, leg in enumerate(LEGS):
            R[f, 4 + k] = rotation((0.0, 0.0, 1.0), np.radians(15.0) * wave[f - 5] * (-1) ** k)
            t[f, 4 + k] = KNEE * leg - R[f, 4 + k] @ (KNEE * leg)
    return R, t


def weights(at: Floats, blend: float = 1.0) -> Floats:
    """(vertex, part) of trunk, pelvis, thighs and shanks."""
    W = np.zeros((len(at), 6))
    above = np.clip(0.5 + (at[:, 0] - SPINE) / (2 * blend), 0.0, 1.0)
    along = at @ LEGS.T
    thigh, shank = (np.clip(0.5 + (along - u) / (2 * blend), 0.0, 1.0) for u in (HIP, KNEE))
    W[:, 0], W[:, 2:4], W[:, 4:] = above, thigh - shank, shank
    W[:, 1] = 1.0 - W.sum(axis=1)
    return W


def bow(of_pelvis: float = 18.0) -> tuple[MovingSurface, FirstTree]:
    """The pipe as it is aligned: the pelvis stays with the thighs, and its joint lies amid spine and hips."""
    R, t = motions(of_pelvis)
    label = np.array([TRUNK, PELVIS, PELVIS, PELVIS, *SHANKS])[weights(V).argmax(axis=1)]
    R, t = R[:, [0, 2, 4, 5]], t[:, [0, 2, 4, 5]]
    x = np.einsum("tvxy,vy->tvx", R[:, label], V) + t[:, label]
    parents, rest = np.array([-1, TRUNK, PELVIS, PELVIS]), np.array([[16.0, 0.0, 0.0], [3.0, 0.0, 0.0], *(KNEE * LEGS)])
    graph = PartGraph(label, np.zeros((0, 2), np.int64), np.zeros((0, 3)), np.zeros(0), np.zeros(0), ())
    tree = FirstTree(
        parents=parents, place=np.arange(4), shown=(), label=label, W=np.eye(4)[label], R=R,
        t=t, certain_share=np.ones((FRAMES, 4)), rest=rest, drift=np.zeros(4), unexplained=np.full((FRAMES, 4), 0.05),
        radius=np.array([0.0, 3.0, 3.0, 3.0]), end_x=np.zeros((FRAMES, 0, 3)), graph=graph,
    )  # fmt: skip
    return MovingSurface(V, F, x, surface_areas(V, F)), tree


def shown(of_pelvis: float = 18.0, noise: float = 0.05) -> Callable[[int], Target]:
    """The frames' surfaces, in other triangles, with noise of their own."""
    fine, faces, _ = y_pipe(30, 5)
    fine = 0.8 * fine
    (R, t), W, size = motions(of_pelvis), weights(fine), float(np.sqrt(surface_areas(V, F).sum()))

    def surface(frame: int) -> Target:
        x = np.einsum("vp,pxy,vy->vx", W, R[frame], fine) + W @ t[frame]
        return Target.of(x + np.random.default_rng(frame).normal(0.0, noise, x.shape), faces, size)

    return surface
