"""A rotation as a swing across an axis after a twist about it (Huyghe, Parsons 2001; Dobrowolski 2015)."""

import numpy as np
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.arrays import Floats


def swing_twist(R: Floats) -> Floats:
    """Twist about y and swing across it, R = swing · twist; of a swing by half a turn the twist is open, and 0 here.

    R       : (frame, 3, 3)
    returns : (frame, 3) degrees: swing about x, twist about y in (−180, 180], swing about z; swings are one rotation vector
    """
    rotation = Rotation.from_matrix(R)
    q = np.asarray(rotation.as_quat())
    y, w = q[:, 1], q[:, 3]
    angle = 2.0 * np.arctan2(y, w)
    angle = np.where(np.hypot(y, w) < 1e-9, 0.0, np.pi - np.mod(np.pi - angle, 2.0 * np.pi))
    twist = Rotation.from_rotvec(angle[:, None] * np.array([0.0, 1.0, 0.0]))
    swing = np.asarray((rotation * twist.inv()).as_rotvec())
    return np.degrees(np.column_stack([swing[:, 0], angle, swing[:, 2]]))
