"""A tube with a joint near its end that the aligned vertices do not show, before frames that do."""

from collections.abc import Callable

import numpy as np
from articulated import Known, chain, moved, swings
from limbs import rotation
from scipy.spatial.transform import Rotation
from shipped import EVIDENCE, TREE

from kinetree.tasks.numerics.arrays import Floats, Ints
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.inertia import inertial_turns
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.tree_joints import Cut, TreeJoints, tree_joints

END = 2.9
"""Height of the joint that is not seen; the other one is at 0, the tube ends at 5."""


def turning(degrees: float = 25.0) -> Floats:
    """(frame, part, 3, 3) the middle part swings, the last one about its joint too."""
    turn = swings(24, 3, 20.0, axes=1, seed=1)
    turn[:, 2] = swings(24, 3, degrees, axes=1, seed=2)[:, 2]
    return turn


def bent_by_flesh(degrees: float) -> Floats:
    """Turns of a tube whose middle part swings; the last one turns by so much as inertia has it."""
    turn = turning(0.0)
    swinging = chain((0.0,), turn[:, :2])
    middle, along = np.array([0.0, 0.0, 2.5]), np.array([0.0, 0.0, END])
    bend = inertial_turns(middle, along, swinging.R[:, 1], swinging.t[:, 1])
    w = np.zeros((len(turn), 3))
    w[1:-1] = list(bend.values())
    w *= np.radians(degrees) / np.sqrt((w**2).sum(axis=1).mean())
    turn[:, 2] = Rotation.from_rotvec(w).as_matrix()
    return turn


def aligned(turn: Floats, bent: float = 0.0) -> Known:
    """The body as aligned: the last part goes with the middle one; the reference shows it bent by so many degrees."""
    body, still = chain((0.0, END), turn, along=60), turn.copy()
    still[:, 0] = still[:, 2] = np.eye(3)
    V, hinge, far = body.V.copy(), np.array([0.0, 0.0, END]), body.V[:, 2] > END
    V[far] = (V[far] - hinge) @ rotation((1.0, 0.0, 0.0), np.radians(bent)).T + hinge
    return moved(V, body.F, body.W, body.joints, body.parents, still)


def found_in(body: Known) -> tuple[MovingSurface, TreeJoints]:
    """The tree of two parts that aligned vertices give."""
    label, tips = (body.V[:, 2] > 0.0).astype(np.int64), np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    cut, surface = Cut(body.V, label, body.R[:, :2], body.t[:, :2], body.residual[:, :2]), moving(body)
    return surface, tree_joints(surface, cut, tips, np.ones(body.x.shape[:2]), settings=TREE)


def three_parts(frames: int = 24, scale: float = 1.0) -> tuple[MovingSurface, TreeJoints]:
    """A tube of three parts in as many frames, aligned as it is."""
    body = chain((0.0, END), turning()[:frames], along=60)
    surface = moving(body)._replace(V=scale * body.V, x=scale * body.x, area=scale**2 * body.area)
    cut = Cut(surface.V, body.label, body.R, scale * body.t, body.residual)
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax()])
    return surface, tree_joints(surface, cut, tips, np.ones(body.x.shape[:2]), settings=TREE)


def moving(body: Known) -> MovingSurface:
    return MovingSurface(body.V, body.F, body.x, body.area)


class Frames:
    """Frames that show the true body in other triangles, with noise of their own."""

    def __init__(self, turn: Floats, noise: float = 0.0, scale: float = 1.0, heights: tuple[float, ...] = (0.0, END)) -> None:
        self.true, self.noise, self.scale = chain(heights, turn, around=27, along=83), noise, scale

    def __call__(self, frame: int) -> tuple[Floats, Ints]:
        x = self.true.x[frame]
        return self.scale * (x + np.random.default_rng(frame).normal(0.0, self.noise, x.shape)), self.true.F

    def prepared(self, size: float) -> Callable[[int], Target]:
        """Their surfaces as pieces are laid on them; size is the root of the body's area."""
        return lambda frame: Target.of(*self(frame), size)

    def evidence(self) -> FrameEvidence:
        of_aligned = np.zeros((len(self.true.x), len(chain((0.0,), along=60).V)))
        return FrameEvidence.of(of_aligned + 1.0, of_aligned, self, EVIDENCE)
