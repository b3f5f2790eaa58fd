"""The constants of an evaluation, with what each of them bounds."""

from typing import NamedTuple


class EvaluationSettings(NamedTuple):
    """Constants of the comparison of a skeleton with the truth; shares are without unit.

    None of them is a limit for a joint's error: those are parameters (`EvaluationParams`).
    """

    box_margin: float = 0.1
    """By how much the body's bounding box is enlarged on every side before true joints are tested against it, share of its
    diagonal. Not recorded what it was chosen on; beyond it a joint counts as outside the body."""
    least_inside: float = 0.5
    """Least share of true joints inside that box in one frame. Below it the frame's joints do not fit the body."""
    least_span: float = 0.2
    """Least longest side of the true joints' bounding box, share of that of the body. Below it they do not fit."""
    least_fitting: float = 0.5
    """Least share of frames in which the true joints fit the body. Below it the truth is refused."""
    rate_tolerance: float = 0.01
    """Largest difference of two frame rates that counts as rounding, share of the sequence's rate. Beyond it the truth is
    refused."""
    rigid_deviation: float = 0.0005
    """Largest standard deviation of the distance between two children of a joint, share of the body's height, up to which they
    move as one rigid group. Chosen on rigs with truth: rigid ones keep such distances to 10⁻⁶, and two bones on opposite sides
    of a joint, which show it least, change them by 10⁻³ when they turn by 37°."""
    bone_step: float = 0.005
    """Distance of the points that stand for a bone, share of the side of the body's cube: as in RigNet's published code."""
    most_permuted: int = 5
    """Most matched joints at one place of which every pairing is tried (5! = 120); more keep the pairing they have."""
