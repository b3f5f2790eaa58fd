"""How far off a joint is expected to be, from what a run knows of it without a truth (ours).

ε_j = size · √(least² + (exp(a) · drift^b · spread^c · residual^d)²)      all lengths in the root of the area
ε_jt = ε_j · (1 + k (1 − confidence_jt))                                  in a frame
"""

from typing import NamedTuple

import numpy as np

from kinetree.tasks.numerics.arrays import Floats
from kinetree.tasks.numerics.structure.joint_consensus import GATE

LEAST = 1e-4
"""Least drift, spread and residual that is told from none, share of the root of the area."""


class PowerLaw(NamedTuple):
    """√(least² + (exp(log_scale) · drift^drift · spread^spread · residual^residual)²), all in the root of the area."""

    log_scale: float
    drift: float
    spread: float
    residual: float
    least: float
    """Error that is left where nothing drifts, spreads or remains: skin that blends tells no joint exactly."""
    bound: float
    """By what the expected error is multiplied to be a bound that nine joints of ten keep."""


class ErrorBarsSettings(NamedTuple):
    """Constants of the expected error.

    Fitted by `python benchmarks/error_bars.py`, which prints them, to the joints of generated people, four-legged animals and
    random trees of even seeds, `least` to those of fixed connectivity too; what they are worth on other bodies stands in
    benchmarks/RESULTS.md.
    """

    several_cuts: PowerLaw = PowerLaw(4.638, 0.0, 0.62, 0.86, 0.00125, 2.751)
    """Where the body was cut in several poses."""
    one_cut: PowerLaw = PowerLaw(4.055, 0.101, 0.0, 1.191, 0.0, 2.903)
    """Where it was cut in one, so that the spread is not known."""
    uncertain: float = 0.5
    """k: how much farther off a joint is in a frame where its confidence is 0."""


class JointFeatures(NamedTuple):
    """What is known of joints; lengths in the mesh unit.

    drift      : (joint,) distance between the joint as its two parts carry it
    spread     : (joint,) of its places over several cuts; NaN where no other cut has it
    residual   : (joint,) what the motions of its two parts leave unexplained
    confidence : (frame, joint) 0 to 1
    size       : root of the area
    """

    drift: Floats
    spread: Floats
    residual: Floats
    confidence: Floats
    size: float

    def logarithms(self, with_spread: bool) -> Floats:
        """(joint, 4) 1, and the logarithms of drift, spread and residual, root of the area.

        A joint that no other cut has is as far from all others as joints of two cuts may be.
        """
        no_spread = GATE if with_spread else 1.0
        spread = np.where(np.isnan(self.spread) | (not with_spread), no_spread * self.size, self.spread)
        rows = [np.log(np.maximum(np.array(a) / self.size, LEAST)) for a in (self.drift, spread, self.residual)]
        return np.stack([np.ones_like(rows[0]), *rows], axis=1)

    def widening(self, uncertain: float) -> Floats:
        """(frame, joint) by what the error grows where the pose is uncertain."""
        return np.asarray(1.0 + uncertain * (1.0 - np.clip(self.confidence, 0.0, 1.0)))


class ErrorBars(NamedTuple):
    """Lengths in the mesh unit.

    expected : (joint,) expected mean error over the frames
    bound    : (joint,) what the mean error exceeds at one joint of ten
    in_frame : (frame, joint) expected error in a frame
    """

    expected: Floats
    bound: Floats
    in_frame: Floats


def error_bars(features: JointFeatures, cuts: int, settings: ErrorBarsSettings | None = None) -> ErrorBars:
    """Expected error of every joint, and a bound that nine of ten keep.

    cuts : poses in which the body was cut
    """
    chosen = settings or ErrorBarsSettings()
    law = chosen.several_cuts if cuts > 1 else chosen.one_cut
    level = features.size * levels(features.logarithms(cuts > 1), law)
    in_frame = level * features.widening(chosen.uncertain)
    expected = in_frame.mean(axis=0) if len(in_frame) else level
    return ErrorBars(expected, law.bound * expected, in_frame)


def levels(rows: Floats, law: PowerLaw) -> Floats:
    """(joint,) expected error where the pose is certain, root of the area; rows as in `JointFeatures.logarithms`."""
    return np.asarray(np.hypot(law.least, np.exp(rows @ np.array([law.log_scale, law.drift, law.spread, law.residual]))))


def fitted(rows: Floats, error: Floats) -> Floats:
    """Coefficients of the least squares of log error on logarithms; none of an exponent is negative.

    rows    : (joint, n) see `JointFeatures.logarithms`
    error   : (joint,) root of the area
    returns : (n,)
    """
    used = np.ones(rows.shape[1], np.bool_)
    goal = np.log(np.maximum(error, LEAST))
    while True:
        coefficients = np.zeros(rows.shape[1])
        coefficients[used] = np.linalg.lstsq(rows[:, used], goal, rcond=None)[0]
        below = np.flatnonzero(coefficients[1:] < 0.0) + 1
        if not len(below):
            return coefficients
        used[below[np.argmin(coefficients[below])]] = False
