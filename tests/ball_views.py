"""A ball in front of a ring of cameras, and what they see of it."""

import json
from pathlib import Path

import numpy as np
import trimesh

from kinetree.tasks.numerics.input.calibration import Calibration, written_calibration
from kinetree.tasks.numerics.input.cameras import Cameras, camera_ring, silhouettes
from kinetree.tasks.numerics.input.silhouettes import write_masks

CENTRE = np.array([10.0, -4.0, 2.0])
RADIUS = 3.0
RING = camera_ring(15, CENTRE, 5.0, (160, 200), elevation=30.0)


def ball_masks(scale: float = 1.0, shift: tuple[float, float, float] = (0.0, 0.0, 0.0), ring: Cameras = RING) -> np.ndarray:
    """(camera, row, column) masks of a long ball, taller than wide, that is scaled and moved."""
    V, F = long_ball(scale, shift)
    return silhouettes(V, F, ring)


def long_ball(scale: float = 1.0, shift: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> tuple[np.ndarray, np.ndarray]:
    ball = trimesh.creation.icosphere(subdivisions=4, radius=RADIUS * scale)
    return ball.vertices * [0.6, 0.6, 1.0] + CENTRE + np.array(shift), np.asarray(ball.faces, dtype=np.int64)


def calibration(ring: Cameras = RING) -> Calibration:
    names = tuple(f"cam_{c:02d}" for c in range(len(ring.P)))
    return Calibration(names, ring.P, (ring.size,) * len(names), "m", 25.0)


def write_folder(folder: Path, frames: int = 3, ring: Cameras = RING) -> Path:
    """A folder of masks with a calibration, the ball higher in every frame."""
    folder.mkdir()
    known = calibration(ring)
    (folder / "calibration.json").write_text(written_calibration(known))
    for t in range(frames):
        write_masks(folder, t, known.names, ball_masks(0.9, (0.0, 0.0, 0.1 * t), ring))
    return folder


def rewrite(folder: Path, **changes: object) -> None:
    """Changes the first camera of the folder's calibration."""
    path = folder / "calibration.json"
    calibration = json.loads(path.read_text())
    calibration["cameras"][0].update(changes)
    path.write_text(json.dumps(calibration))
