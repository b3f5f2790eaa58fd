"""The articulated body as the aligned vertices show it, how its tree came about, and its uncertain frames (2014, Sec. 6.3)."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, ClassVar

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from kinetree.schemas.array import Array, Bools, Floats, Index, Ints, Params
from kinetree.schemas.dims import END, FRAME, JOINT, PAIR, PART, VERTEX, XYZ
from kinetree.schemas.structure.extended_tree import ExtendedTreeParams
from kinetree.schemas.structure.first_tree import Drop
from kinetree.schemas.structure.skeleton import ArticulatedBody

MOST_TOGETHER = 2
"""Uncertain frames that are refined by one task, at most."""


class PruningParams(Params):
    """How much a joint turns."""

    degrees: float = Field(default=6.0, ge=0, le=180)
    """A joint turns by at least this many degrees between some two frames, or its parts are one."""
    ratio: float = Field(default=0.8, ge=0)
    """Displacement that turning gives a joint's smaller part, in drifts of the joint; below it the part slides, like cloth."""


class JointParams(PruningParams):
    """What counts as a joint."""

    clear_motion: float = Field(default=5.0, ge=0)
    """Displacement, in roughnesses of its surface, from which on a part moves clearly, so that its joint is not tested."""
    misfit_ratio: float = Field(default=1.6, ge=0)
    """A tested joint stays if its two parts as one piece lie this many times farther off the frames' surfaces than as two."""
    misfit_ratio_if_moving: float = Field(default=1.1, ge=0)
    """The same where some other joint of the body moves clearly."""


class HiddenBonesParams(Params):
    """Which bones no cut can find."""

    hidden_bones: bool = True
    """Whether bones under skin that is nowhere rigid, as in short necks, are looked for where every vertex was followed, and
    bones that their length alone shows, as between pelvis and thigh."""


class CutJointsParams(HiddenBonesParams, PruningParams):
    """What counts as a joint of a cut."""


class FirstTreeParams(JointParams, CutJointsParams):
    """What counts as a joint, and where joints are looked for."""


class AgreedTreeParams(JointParams):
    """What counts as a joint, and whether joints that an alignment smears are looked for."""

    end_joints: bool = True
    """Whether joints that an alignment smears, as balls of feet and spines, are looked for on the frames' surfaces."""


class ShapeParams(Params):
    """Which joints shape alone gives."""

    necks: bool = True
    """Whether a tube between the last part of a limb and what carries it, as a neck, has a joint at its lower end and one
    beyond its upper end though motion shows one alone; a joint far from both places is moved to the nearer one."""
    narrowings: bool = True
    """Whether both limbs of a pair have a joint where a hand or foot begins, at a narrowing of the limb, though motion shows
    none there; not where connectivity is fixed, nor on a body with a single pair of such limbs."""
    mirrored_joints: bool = True
    """Whether a limb has the joints at its end that its mirror image has, though they show no turn; not where connectivity is
    fixed, nor on a body with a single pair of such limbs."""
    spine: bool = True
    """Whether joints of a person's spine lie behind the middle of the trunk, as vertebrae do, and amid it from side to side,
    where toes, knees and travel tell the front; not where connectivity is fixed. Where a run names the wrong front, switch it
    off."""


class PlacedTreeParams(ShapeParams, HiddenBonesParams):
    """Which joints shape alone gives, or the length of bones."""


class KinematicTreeParams(PlacedTreeParams, ExtendedTreeParams, AgreedTreeParams, FirstTreeParams):
    """What counts as a joint, and where joints are looked for and placed."""


class KinematicTree(ArticulatedBody):
    """A body whose poses come from aligned vertices alone; each run of uncertain frames opens a member of "doubt".

    Parts are numbered as the cut in `cut_frame` numbers them, which is RigidParts where that is the reference.
    """

    opens: ClassVar[tuple[str, ...]] = ("doubt", "doubt/frame")
    uncertain: Annotated[Bools, Array("bool", FRAME)]
    """Frames in which some part has so little confidence that the body is fitted to the surface."""
    cut_frame: int | None = None
    """Source frame of the cut whose tree this is, if another than that in the reference, with which other cuts agree more.
    Where vertices were aligned, how far its limbs are mirror images of each other counts, too."""
    part: Annotated[Ints, Array("int32", VERTEX)]
    """Part of each vertex, before any was dropped."""
    pair: Annotated[Ints, Array("int32", PAIR, END)]
    """Parts that meet, before any was dropped."""
    centre: Annotated[Floats, Array("float64", PAIR, XYZ, unit="length")]
    """The point of the reference mesh that the two turn about best."""
    border_drift: Annotated[Floats, Array("float64", PAIR, unit="length")]
    """Root mean square distance between that point as one part and as the other carries it."""
    border_degrees: Annotated[Floats, Array("float64", PAIR, unit="°", finite=False)]
    """Range of their turning against each other; NaN for borders that the spanning tree of all parts does not have."""
    joint_of_part: Annotated[Ints, Array("int32", PART)]
    """Joint about which each part turns, −1 for parts that were dropped."""
    dropped: tuple[Drop, ...]
    """Parts that were dropped, in that order."""
    free_length: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Mean length of each joint's bone as the parts alone carry its ends, before lengths are held; 0 for the root."""
    free_deviation: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Standard deviation of that length over the frames; held lengths have none."""
    cuts: int = 1
    """Cuts of the body into rigid parts, each in another pose, whose joints were averaged."""
    spread: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance of these cuts' joints from their mean; NaN where one cut alone has the joint, and for root and
    leaves."""
    agreeing: Annotated[Ints, Array("int32", JOINT)]
    """Cuts that have each joint; 0 for root and leaves."""
    joint_residual: Annotated[Floats, Array("float64", JOINT, unit="length")]
    """Root mean square of what the motions of the joint's two parts leave unexplained; 0 for root and leaves."""
    surface_offset: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance of each joint from where halves of the frames' surfaces alone have it; NaN where connectivity
    is fixed, where the surfaces do not say, and for root and leaves."""
    hinge_offset: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance of each joint, along its limb, from where halves of the frames' surfaces bend it; NaN also
    where no straight limb is on both sides."""
    border_radius: Annotated[Floats, Array("float64", JOINT, unit="length", finite=False)]
    """Root mean square distance of the line between a joint's two parts from the middle of it; NaN for root and leaves."""
    partner: Annotated[Ints, Array("int32", JOINT)]
    """The joint that is its mirror image in the other limb of a pair; −1 where there is none."""
    is_given: bool = False
    """Whether the frames give the correspondence, as with fixed connectivity, so that no alignment moves a joint."""
    end_joints: tuple[int, ...] = ()
    """Joints that the frames' surfaces alone show: aligned vertices smear their turn, so that every frame is looked at."""
    neck_joints: tuple[int, ...] = ()
    """Joints that the shape alone shows, on a tube with another one that turns. They turn by nothing, since motion shows no
    turn of theirs."""
    mirrored_joints: tuple[int, ...] = ()
    """Joints that their mirror images alone show, at the same distance from the end of the limb. They turn by nothing."""
    narrowing_joints: tuple[int, ...] = ()
    """Joints that narrowings of limbs alone show, as wrists that turn about the forearm's axis. They turn by nothing."""

    @property
    def length_variation(self) -> Floats:
        """(joint,) deviation of the length before it is held, % of its mean; 0 for the root."""
        variation: Floats = 100.0 * self.free_deviation / (self.free_length + (self.free_length == 0.0))
        return variation

    @property
    def in_tree(self) -> Bools:
        """(pair,) whether the spanning tree of all parts has each border as a joint."""
        return np.asarray(np.isfinite(self.border_degrees))

    def runs(self) -> tuple[tuple[int, ...], ...]:
        """Uncertain source frames, neighbours together, a few at a time."""
        return tuple(map(self._numbers, self._rows()))

    def _rows(self) -> list[NDArray[np.intp]]:
        """By run, the rows of its frames."""
        at = np.flatnonzero(self.uncertain)
        ends = [0, *(np.flatnonzero(np.diff(at) > 1) + 1), len(at)]
        return [at[k : min(k + MOST_TOGETHER, b)] for a, b in pairwise(ends) for k in range(a, b, MOST_TOGETHER)]

    def _numbers(self, rows: NDArray[np.intp]) -> tuple[int, ...]:
        return tuple(self.frames[t] for t in rows)

    def members(self, space: str, index: Index) -> Sequence[int]:
        """The runs of uncertain frames, numbered from 0, or the source frames of one."""
        rows = self._rows()
        return range(len(rows)) if space == "doubt" else self._numbers(rows[index[0]])
