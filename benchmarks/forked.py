"""Figures several of whose limbs hang on one joint, as both legs of some rigs do: a trunk that bends, and limbs at its top."""

from typing import Any

import numpy as np


def forked(seed: int) -> dict[str, Any]:
    """A figure for `kinetree synth`: two limbs of even seeds, three of odd ones; sizes and motion by the seed."""
    rng = np.random.default_rng(seed)
    limbs, thick, length, height = 2 + seed % 2, rng.uniform(45, 85), rng.uniform(420, 620), rng.uniform(500, 800)
    joints: list[dict[str, Any]] = [
        {"name": "root", "position": [0, 0, 0], "radius": 1.4 * thick},
        {"name": "waist", "parent": "root", "position": [0, 0, 0.45 * height], "radii": [1.4 * thick, 1.3 * thick]},
    ]
    motion = {"waist": [_curve(rng, [1, 0, 0], (12, 25), (0.8, 0.8))]}
    for k in range(limbs):
        around, tilt = 2 * np.pi * k / limbs + rng.uniform(-0.2, 0.2), rng.uniform(0.5, 0.9)
        way = np.array([np.sin(tilt) * np.cos(around), np.sin(tilt) * np.sin(around), np.cos(tilt)])
        hinge = np.cross(way, [0, 0, 1]) / np.sin(tilt)
        top, widths = np.array([0, 0, height]), thick * np.array([1.3, 1.2, 1.1, 1.0, 0.9, 0.8, 0.7, 0.6])
        parent = "waist"
        for name, reach, radii in (("fork", 0.0, widths[:3]), ("elbow", 0.55, widths[3:6]), ("end", 1.0, widths[5:])):
            place = (top + reach * length * way).tolist()
            joints.append({"name": f"{name}_{k}", "parent": parent, "position": place, "radii": radii.tolist()})
            parent = f"{name}_{k}"
        motion[f"fork_{k}"] = [_curve(rng, hinge, (12, 22), (0.6, 1.1)), _curve(rng, way, (0, 12), (0.9, 0.9))]
        motion[f"elbow_{k}"] = [_curve(rng, hinge, (15, 30), (0.7, 1.2))]
    return {"name": "fork", "unit": "mm", "fps": 25, "joints": joints, "motions": {"move": motion}}


def _curve(rng: np.random.Generator, axis: Any, degrees: tuple[float, float], a_second: tuple[float, float]) -> dict[str, Any]:
    """One swing about an axis, its amplitude and frequency within ranges, at any phase."""
    amplitude, frequency, phase = rng.uniform(*degrees), rng.uniform(*a_second), rng.uniform()
    return {"axis": np.asarray(axis, float).tolist(), "amplitude": amplitude, "frequency": frequency, "phase": phase}
