"""How far off a joint is expected to be, from what a run knows of it without a truth (ours).

ε_j = size · √(least² + (exp(a) · drift^b · spread^c · residual^d · turning^e · length^f · offset^g · resistance^h
                                                    · hinge^i · below^j · softness^k)²)
                                                                          lengths in the root of the area
where the frames give every vertex, least = κ · radius of the border
where the joint has a mirror image, of several cuts, ε_j becomes ε_j^(1 − n) · u^n, u = difference between the bones' lengths
ε_jt = ε_j · (1 + m (1 − confidence_jt))                                  in a frame
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Flags, Floats
from kinetree.tasks.numerics.structure.joint_consensus import GATE

LEAST = 1e-4
"""Least length of any kind that is told from none, share of the root of the area."""
DIRECTIONS = (1, 1, 1, -1, -1, 1, 1, 1, -1, 1)
"""Whether the error may only grow, or only fall, with each field of `PowerLaw` from drift on."""
LEAST_DEGREES = 1.0
"""Least range of turning that is told from none."""
LEAST_RESISTANCE = 1e-4
"""Least resistance that is told from none."""
LEAST_SOFTNESS = 0.01
"""Least softness of skin that is told from none."""
MOST_RESISTANCE = 1 / 3
"""Resistance that counts where none is known: no surface has more, see `resistance_about`."""


class PowerLaw(NamedTuple):
    """√(least² + (exp(log_scale) · drift^drift · …)²), lengths in the root of the area; the fields are the exponents."""

    log_scale: float
    drift: float
    spread: float
    residual: float
    degrees: float
    length: float
    offset: float
    resistance: float
    hinge: float
    below: float
    softness: float
    least: float
    """Error that is left where nothing drifts, spreads or remains: skin that blends tells no joint exactly."""
    bound: float
    """By what the expected error is multiplied to be a bound that nine joints of ten keep."""

    @property
    def coefficients(self) -> Floats:
        """Of the columns of `JointFeatures.logarithms`."""
        return np.array(self[: len(DIRECTIONS) + 1])


class ErrorBarsSettings(NamedTuple):
    """Constants of the expected error.

    The laws are fitted by `python benchmarks/error_bars.py`, which prints them, to the joints of generated people, four-legged
    animals and random trees of even seeds; those for several cuts also to spoilt ones. The others say what they were chosen on.
    What they are worth on other bodies stands in benchmarks/RESULTS.md.
    """

    several_cuts: PowerLaw = PowerLaw(0.925, 0.229, 0.31, 0.3, -0.436, -0.57, 0.0, 0.0, 0.0, 0.0, 0.0, 0.00125, 2.52)
    """Where the body was cut in several poses."""
    on_surfaces: PowerLaw = PowerLaw(
        1.594, 0.075, 0.223, 0.143, -0.109, -0.225, 0.283, 0.251, 0.097, -0.033, 0.177, 0.00225, 2.154
    )
    """The same, where joints have surface offsets: a fifth of the way from the best fit to the law above, so that errors of
    bodies left out are foretold best. The bound is one that people, four-legged animals and random trees keep, each; the least
    error is the smallest with which nine of ten joints in 36 frames keep it, too."""
    one_cut: PowerLaw = PowerLaw(5.639, 0.417, 0.0, 0.982, -0.578, -0.42, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0035, 2.426)
    """Where it was cut in one, so that the spread is not known."""
    along_axis: float = 0.05
    """κ: error of a joint along the line that it turns about, radii of its border, where the frames give every vertex. A hinge
    leaves its place along that line open, and there the middle of the border decides; it drifts by nothing. Takes the place
    of `least` of several cuts. Chosen on generated bodies of fixed connectivity of even seeds; 0.05 to 0.06 hold alike."""
    end_joint: float = 0.5
    """Error of a joint that the frames' surfaces show, see `extended_tree`, as a share of what the law gives for the same
    evidence: few other cuts have it, so that its spread mostly counts as the widest, and yet the surfaces place it well. With
    0.45, 0.5 and 0.55 81, 91 and 97 % of 32 such joints of generated bodies keep the bound; of those that it was not chosen
    on, with 0.5, 98 % of 52, and of recorded bodies and a rigged one 32 of 34."""
    across_tube: float = 0.4
    """Error of a joint that its own shape alone shows, radii of its tube, see `necks`. On 45 people and 12 other generated
    bodies 35 such joints err by 0.25 in the geometric mean and nine tenths of them by 0.48 at most; in 27 motions of a
    recorded body 26 joints err by 0.50 and 0.86."""
    across_mirrored: float = 0.55
    """Error of a joint that its mirror image alone shows, radii of its ring, see `mirrored_joints`. With it 93 % of 27 such
    joints of generated people, on which it was chosen, keep the bound, of 13 on a rigged body 8; with 0.4 81 %, and 6."""
    across_narrowing: float = 0.5
    """Error of a joint that a narrowing of its limb alone shows, radii of it, see `narrowings`. With it 13 of 14 such joints of
    people 0 to 14, 100 to 114 and 215 to 229, on which it was chosen, keep the bound, of six others 4; with 0.4 12."""
    alike: float = 0.12
    """n: how much the lengths of a joint's bone and of its mirror image say. Fitted to 1,452 joints of people 780 to 879 and 0
    to 9 (0.11 ± 0.01); 102 of other generated bodies have 0.14 ± 0.07, 112 of recorded ones 0.12 ± 0.05."""
    uncertain: float = 0.5
    """m: how much farther off a joint is in a frame where its confidence is 0."""


class JointFeatures(NamedTuple):
    """What is known of joints; lengths in the mesh unit.

    drift      : (joint,) distance between the joint as its two parts carry it
    spread     : (joint,) of its places over several cuts; NaN where no other cut has it
    residual   : (joint,) what the motions of its two parts leave unexplained
    degrees    : (joint,) range of turning
    length     : (joint,) of the bone to its parent
    offset     : (joint,) from where halves of the frames' surfaces alone have the joint; NaN where they do not say
    resistance : (joint,) of its parts against turning about it, see `turning_resistance`; NaN where it is not known
    hinge      : (joint,) along its limb from where halves of the frames' surfaces bend it; NaN where they do not say
    below      : (joint,) range of turning of the joint right below that turns most, degrees; 0 where there is none
    softness   : (joint,) of the skin near the joint, 0 to 1, see `skin_softness`
    radius     : (joint,) of the border at the joint where the frames give every vertex; NaN where they do not
    is_end_joint : (joint,) whether the frames' surfaces show the joint, see `extended_tree`
    tube       : (joint,) radius of the tube where its own shape alone shows the joint; NaN elsewhere
    narrowing  : (joint,) radius of the narrowing where that alone shows the joint; NaN elsewhere
    mirrored   : (joint,) radius of the ring where its mirror image alone shows the joint; NaN elsewhere
    asymmetry  : (joint,) difference between the lengths of its bone and of that bone's mirror image; NaN where it has none
    confidence : (frame, joint) 0 to 1
    size       : root of the area
    """

    drift: Floats
    spread: Floats
    residual: Floats
    degrees: Floats
    length: Floats
    offset: Floats
    resistance: Floats
    hinge: Floats
    below: Floats
    softness: Floats
    radius: Floats
    is_end_joint: Flags
    tube: Floats
    narrowing: Floats
    mirrored: Floats
    asymmetry: Floats
    confidence: Floats
    size: float

    def logarithms(self, with_spread: bool) -> Floats:
        """(joint, 11) 1, and the logarithms of the evidence in the order of `PowerLaw`; lengths in roots of the area.

        A joint that no other cut has is as far from all others as joints of two cuts may be. No offset is as the whole body;
        where no hinge is known the offset stands for it.
        """
        no_spread = GATE if with_spread else 1.0
        spread = np.where(np.isnan(self.spread) | (not with_spread), no_spread * self.size, self.spread)
        offset = np.where(np.isnan(self.offset), self.size, self.offset)
        lengths = (self.drift, spread, self.residual, self.length, offset, np.where(np.isnan(self.hinge), offset, self.hinge))
        *evidence, length, offset, hinge = (np.log(np.maximum(np.array(a) / self.size, LEAST)) for a in lengths)
        degrees, below = (np.log(np.maximum(a, LEAST_DEGREES)) for a in (self.degrees, self.below))
        resistance = np.where(np.isnan(self.resistance), MOST_RESISTANCE, self.resistance)
        resistance = np.log(np.maximum(resistance, LEAST_RESISTANCE))
        softness = np.log(np.maximum(self.softness, LEAST_SOFTNESS))
        known = (*evidence, degrees, length, offset, resistance, hinge, below, softness)
        return np.stack([np.ones_like(degrees), *known], axis=1)

    def widening(self, uncertain: float) -> Floats:
        """(frame, joint) by what the error grows where the pose is uncertain."""
        return np.asarray(1.0 + uncertain * (1.0 - np.clip(self.confidence, 0.0, 1.0)))


class ErrorBars(NamedTuple):
    """Lengths in the mesh unit.

    expected : (joint,) expected mean error over the frames
    bound    : (joint,) the distance that the mean error of nine joints of ten keeps
    in_frame : (frame, joint) expected error in a frame
    """

    expected: Floats
    bound: Floats
    in_frame: Floats


def error_bars(features: JointFeatures, cuts: int, settings: ErrorBarsSettings | None = None) -> ErrorBars:
    """Expected error of every joint, and a bound that nine of ten keep.

    cuts : poses in which the body was cut
    """
    chosen, rows = settings or ErrorBarsSettings(), features.logarithms(cuts > 1)
    law = chosen.several_cuts if cuts > 1 else chosen.one_cut
    if cuts > 1 and np.isfinite(features.offset).any():
        law = chosen.on_surfaces
    level = features.size * levels(rows, law)
    if cuts > 1:
        along = chosen.along_axis * features.radius
        level = np.where(np.isnan(along), level, np.hypot(along, features.size * levels(rows, law._replace(least=0.0))))
        level *= np.where(features.is_end_joint, chosen.end_joint, 1.0)
        unlike = np.maximum(features.asymmetry, law.least * features.size)
        level = np.where(np.isnan(unlike), level, level ** (1.0 - chosen.alike) * unlike**chosen.alike)
    assumed = (
        (features.tube, chosen.across_tube),
        (features.narrowing, chosen.across_narrowing),
        (features.mirrored, chosen.across_mirrored),
    )
    for radius, share in assumed:
        level = np.where(np.isnan(radius), level, share * radius)
    in_frame = level * features.widening(chosen.uncertain)
    expected = in_frame.mean(axis=0) if len(in_frame) else level
    return ErrorBars(expected, law.bound * expected, in_frame)


def levels(rows: Floats, law: PowerLaw) -> Floats:
    """(joint,) expected error where the pose is certain, root of the area; rows as in `JointFeatures.logarithms`."""
    return np.asarray(np.hypot(law.least, np.exp(rows @ law.coefficients)))


def fitted(rows: Floats, error: Floats) -> Floats:
    """Coefficients of the least squares of log error on logarithms; no exponent goes against `DIRECTIONS`.

    rows    : (joint, n) see `JointFeatures.logarithms`
    error   : (joint,) root of the area
    returns : (n,)
    """
    used = np.ones(rows.shape[1], np.bool_)
    goal = np.log(np.maximum(error, LEAST))
    while True:
        coefficients = np.zeros(rows.shape[1])
        coefficients[used] = np.linalg.lstsq(rows[:, used], goal, rcond=None)[0]
        signed = coefficients[1:] * np.array(DIRECTIONS[: len(used) - 1])
        if not (signed < 0.0).any():
            return coefficients
        used[1 + np.argmin(signed)] = False
