"""Where along a limb the frames' own surfaces bend it (ours).

An alignment smears a bend, so that the border between two parts may lie beside it, in all cuts alike. Parts that are cut there
and laid on the surfaces confirm a joint that is wrong. So the two parts are laid as one piece with a hinge, at several places
along the limb, and every point goes with the part on its side of the hinge (`hinge_costs`). The joint goes to the place that
leaves least, if that is clearly less than what the joint leaves, and if halves of the frames agree on it, and two shapes of the
border: a plane across the limb, and the line that was cut. Labels and skinning weights stay as they were cut.

Short bones, as between pelvis and chest, are flesh as much as bone: their joint moves only where far less is left.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.structure.first_tree import FirstTree


class HingePlacesSettings(NamedTuple):
    """Which joints move, and how far; lengths are in radii of the border.

    `agree`, `length`, `straight` and `gain` were chosen on wave and on generated humans, quadrupeds and random trees of seeds 0
    and 2.
    """

    agree: float = 0.5
    """Distance between two estimates of a place, share of the way that the joint goes, at most. Compared are two halves of the
    frames, and both shapes of the border. From 0.25 to 0.7 those bodies gain alike."""
    length: float = 1.25
    """Length of the bones on both sides of a joint, at least: a shorter part is flesh as much as bone. From 1 to 1.5 those gain
    alike, at 2 less."""
    straight: float = 0.4
    """Cosine of the angle between these bones in the reference, at least: at an ankle no direction is along the limb. From 0.4
    to 0.7 those gain alike."""
    gain: float = 0.04
    """How much less the best place leaves than the joint, share of that, at least: places about a joint that does not bend
    differ by noise, mostly below 0.04. From 0.02 to 0.04 those bodies gain alike; at 0 more, as joints move for noise."""
    short_length: float = 0.3
    """Length of the bones on both sides of a joint from which on it may move if more is gained (`short_gain`). Joints that gain
    on the bodies named there have 0.43 and more. Not varied."""
    short_straight: float = 0.7
    """Cosine of the angle between such bones, at least. Joints that gain have 0.73 and more. Not varied."""
    short_gain: float = 0.15
    """How much less the best place leaves than the joint where bones are short or bent, or where the frames divide the trunk,
    share of that, at least. Chosen with `short_straight` on people 0 to 19 and 60 to 69, wave, dance, ballet, wolf and
    generated humans, quadrupeds and random trees of seeds 0 to 4 and 60 to 64, on which it moves 17 joints: three spines more
    are found, no joint is lost. Of those below, one with 0.142 would come nearer, others with 0.08 to 0.144 would move away."""
    share: float = 0.5
    """Way of a joint, share of the bone on that side, at most: so joints of one limb cannot pass each other, also where both
    move. No joint of long bones goes farther than 0.2."""
    carried_apart: float = 0.25
    """Drift of a joint at its new place, in radii, at most, if it is also more than `times_apart` of what it was: where its two
    parts are carried apart they do not turn about a common joint. Two joints of the trunk would go beside another one with 0.29
    and 0.31, 8.5 and 8.9 of what it was (people 600 at 6 frames a second, 725); others that move have 0.22 at most."""
    times_apart: float = 3.0
    """See `carried_apart`."""
    least_frames: int = 8
    """Frames of a take that is judged by itself, at least. Not varied."""
    margin: float = 0.8
    """Parts are laid at joints with this share of `length` and `straight`, since further cuts then move the joints a little."""
    reach: float = 3.0
    """Places lie as far as this on either side of the joint. From 1 to 4 those gain alike."""
    step: float = 0.5
    """From one place to the next. Not varied."""
    near: float = 4.0
    """Distance from the joint within which points may change sides. Not varied."""
    points: int = 250
    """Points of both parts, about; for time."""
    least_points: int = 8
    """Points on either side of a hinge, at least. Not varied."""
    rigid_weight: float = 0.75
    """Skinning weight of both parts together from which on a vertex is laid. Not varied."""

    @property
    def places(self) -> Floats:
        """(place,) along the limb, in radii; the one amid them is the joint."""
        count = round(self.reach / self.step)
        return np.asarray(self.step * np.arange(-count, count + 1), np.float64)

    @property
    def of_short(self) -> "HingePlacesSettings":
        """What is asked where bones are short."""
        return self._replace(length=self.short_length, straight=self.short_straight, gain=self.short_gain)


class HingeCosts(NamedTuple):
    """What two parts leave of the frames' surfaces with a hinge at each place.

    joint  : (hinge,) in the tree's order, ascending
    end    : (hinge, xyz) where the bone beyond the joint ends, mesh unit
    square : (laid, hinge, border shape, place) mean squared distance, mesh unit²
    """

    joint: Ints
    end: Floats
    square: Floats


def hinge_shifts(
    tree: FirstTree, costs: HingeCosts, rest: Floats, certain: Floats, spans: Sequence[Flags] = (),
    settings: HingePlacesSettings | None = None,
) -> Floats:  # fmt: skip
    """(part, xyz) shift of every joint to where the surfaces bend its limb, mesh unit; 0 for joints that stay.

    rest    : (part, xyz) the joints in the reference, mesh unit
    certain : (laid, part) share of its surface that is certain, 0 to 1
    spans   : (laid,) each, frames that are judged together: all, and of several takes each. The first that agrees counts
    """
    chosen, shifts = settings or HingePlacesSettings(), np.zeros_like(rest)
    spans = [span for span in spans if span.sum() >= chosen.least_frames] or [np.ones(len(certain), np.bool_)]
    for limb in _limbs(tree, costs, rest, certain, chosen):
        way = next((way for span in spans if (way := _agreed(limb.along, limb.square[span], limb.limits))), 0.0)
        if abs(way) < chosen.share * limb.room[int(way > 0.0)]:
            shifts[limb.joint] = way * limb.axis
    before, after = tree.drift_at(rest), tree.drift_at(rest + shifts)
    shifts[after > np.maximum(chosen.carried_apart * tree.radius, chosen.times_apart * before)] = 0.0
    return shifts


def hinge_offsets(
    tree: FirstTree, costs: HingeCosts, rest: Floats, certain: Floats, settings: HingePlacesSettings | None = None
) -> Floats:
    """(part,) root mean square distance of a joint from where halves of the frames bend its limb; NaN without long bones.

    Arguments are as in `hinge_shifts`; a place is that of one border shape. A half that bends the limb least at an end of the
    places counts with that end.
    """
    offsets = np.full(len(rest), np.nan)
    for limb in _limbs(tree, costs, rest, certain, settings or HingePlacesSettings()):
        if not limb.is_long:
            continue
        ways, least = _ways_of_halves(limb)
        offsets[limb.joint] = np.sqrt(np.square(np.where(np.isnan(ways), least, ways)).mean())
    return offsets


def hinge_ways(
    tree: FirstTree, costs: HingeCosts, rest: Floats, certain: Floats, settings: HingePlacesSettings | None = None
) -> dict[int, Floats]:
    """By joint, (half and border shape,) ways along its limb to where halves of the frames bend it, mesh unit; infinite where
    that lies at an end of the places.

    Arguments are as in `hinge_shifts`.
    """
    limbs = _limbs(tree, costs, rest, certain, settings or HingePlacesSettings())
    return {limb.joint: np.nan_to_num(_ways_of_halves(limb)[0], nan=np.inf) for limb in limbs}


class _Limb(NamedTuple):
    """A joint within a limb: (xyz,) its axis, `along` (place,) of the hinge from the joint, mesh unit.

    is_long : whether its bones are long and straight
    limits  : what is asked of it
    room    : (2,) to the joint above and to those below, mesh unit
    square  : (laid, border shape, place) mean squared distances, by how certain a frame is
    """

    joint: int
    axis: Floats
    is_long: bool
    limits: HingePlacesSettings
    room: Floats
    along: Floats
    square: Floats


def _limbs(tree: FirstTree, costs: HingeCosts, rest: Floats, certain: Floats, chosen: HingePlacesSettings) -> Iterator[_Limb]:
    """The joints of `costs` whose limb is long and straight enough; arguments as in `hinge_shifts`."""
    anywhere, is_divided = chosen._replace(length=0.0, straight=-np.inf), tree.in_divided_trunk
    for k, (joint, end) in enumerate(zip(costs.joint.tolist(), costs.end, strict=True)):
        axis = limb_axis(tree, tree.rest, joint, end, anywhere)
        is_long, is_enough = (limb_axis(tree, rest, joint, end, of) is not None for of in (chosen, chosen.of_short))
        if axis is None or not (is_long or is_enough):
            continue
        share = np.minimum(certain[:, joint], certain[:, tree.parents[joint]]) + 1e-3
        along = chosen.places * tree.radius[joint] - (rest[joint] - tree.rest[joint]) @ axis
        limits = chosen if is_long and not is_divided[joint] else chosen.of_short
        room = _room(tree, rest, joint, end, axis, chosen)
        yield _Limb(joint, axis, is_long, limits, room, along, share[:, None, None] * costs.square[:, k])


def _room(tree: FirstTree, rest: Floats, joint: int, end: Floats, axis: Floats, chosen: HingePlacesSettings) -> Floats:
    """(2,) from a joint to the one above and to those below, mesh unit.

    The root's place is no joint: there the nearest of its joints counts that lies behind this one, along the axis.
    """
    above, below = np.linalg.norm(_bones(tree, rest, joint, end), axis=1)
    if tree.parents[joint] == 0:
        away = rest[(tree.parents == 0) & (np.arange(len(rest)) != joint)] - rest[joint]
        length = np.linalg.norm(away, axis=1)
        above = min(length[-away @ axis > chosen.short_straight * length], default=above)
    return np.array([above, below])


def limb_axis(tree: FirstTree, rest: Floats, joint: int, end: Floats, settings: HingePlacesSettings) -> Floats | None:
    """(xyz,) amid the directions of the bones that meet at a joint; None where they are too short or too bent.

    rest : (part, xyz) the joints in the reference, mesh unit
    end  : (xyz,) see `HingeCosts`; where parts hang on the one beyond the joint, their joints count instead
    """
    bones = _bones(tree, rest, joint, end)
    length = np.linalg.norm(bones, axis=1)
    if length.min() < settings.length * tree.radius[joint] or length.min() <= 0.0:
        return None
    one, other = bones / length[:, None]
    amid = np.linalg.norm(one + other)
    return None if one @ other < settings.straight or amid <= 0.0 else np.asarray((one + other) / amid)


def _bones(tree: FirstTree, rest: Floats, joint: int, end: Floats) -> Floats:
    """(2, xyz) from the joint above to a joint, and on to the mean of the joints below or the end, mesh unit."""
    below = np.flatnonzero(tree.parents == joint)
    end = rest[below].mean(axis=0) if len(below) else end
    return np.stack([rest[joint] - rest[tree.parents[joint]], end - rest[joint]])


def _ways_of_halves(limb: _Limb) -> tuple[Floats, Floats]:
    """(half and border shape,) ways to where each half of the frames bends a limb, NaN at an end of the places · ways to the
    place of those tried that leaves least; mesh unit.
    """
    sums = np.concatenate([limb.square[half].sum(axis=0) for half in _halves(len(limb.square))])
    return np.array([_least(limb.along, cost) for cost in sums]), limb.along[sums.argmin(axis=1)]


def _agreed(along: Floats, square: Floats, chosen: HingePlacesSettings) -> float:
    """The way that a joint goes; 0 where shapes of the border or halves of the frames disagree, or where little is gained.

    along, square : (place,) from the joint, mesh unit · (frame, border shape, place)
    """
    sets = (np.ones(len(square), np.bool_), *_halves(len(square)))
    ways = np.array([[_least(along, cost) for cost in square[of].sum(axis=0)] for of in sets])
    way = float(ways[0].mean())
    halves_agree = (np.abs(ways[[1, 3]] - ways[[2, 4]]) < chosen.agree * np.abs(ways[0])).all()
    shapes_agree = abs(ways[0, 0] - ways[0, 1]) < chosen.agree * abs(way)
    gains = all(cost.min() < (1.0 - chosen.gain) * np.interp(0.0, along, cost) for cost in square.sum(axis=0))
    return way if halves_agree and shapes_agree and gains else 0.0


def _halves(frames: int) -> tuple[Flags, ...]:
    """Each second frame and the others, each second quarter and the others; (frame,) each."""
    frame = np.arange(frames)
    quarter = frame * 4 // max(frames, 1)
    return frame % 2 == 0, frame % 2 == 1, quarter % 2 == 0, quarter % 2 == 1


def _least(along: Floats, cost: Floats) -> float:
    """Where the parabola through the least cost and its neighbours is least, NaN where that is at an end; both (place,)."""
    k = int(cost.argmin())
    if k in (0, len(cost) - 1):
        return np.nan
    before, least, after = cost[k - 1 : k + 2]
    bend = max(float(before - 2.0 * least + after), np.finfo(float).tiny)
    return float(along[k] + (along[1] - along[0]) * 0.5 * (before - after) / bend)
