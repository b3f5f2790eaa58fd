"""Joints as C3D (c3d.org), written by ezc3d, which the extra `c3d` installs (ours)."""

import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from kinetree.errors import ConfigError
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.markers import markers


def c3d(skeleton: Skeleton, up: str) -> bytes:
    """The bytes of a C3D file of a body in millimetres; a missing frame has markers with residual −1.

    up     : axis that points up: y or z
    raises : ConfigError where the extra is not installed
    """
    clip = markers(skeleton)
    missing = np.isnan(clip.positions).any(axis=2)
    points = np.ones((4, *clip.positions.shape[1::-1]))
    points[:3] = clip.positions.transpose(2, 1, 0)
    file = _ezc3d().c3d()
    point = file["parameters"]["POINT"]
    point["UNITS"]["value"], point["RATE"]["value"], point["LABELS"]["value"] = ["mm"], [clip.rate], clip.names
    file.add_parameter("POINT", "X_SCREEN", ["+X"])
    file.add_parameter("POINT", "Y_SCREEN", [f"+{up.upper()}"])
    file["data"]["points"] = points
    file["data"]["meta_points"]["residuals"] = np.where(missing, -1.0, 0.0).T[None]
    file["data"]["meta_points"]["camera_masks"] = np.zeros((7, *points.shape[1:]), bool)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "skeleton.c3d"
        file.write(str(path))
        return path.read_bytes()


def _ezc3d() -> Any:
    """The library, which has no types; raises ConfigError where it is not installed."""
    try:
        return import_module("ezc3d")
    except ImportError:
        raise ConfigError("C3D needs a package that is not installed: pip install 'kinetree[c3d]' brings it") from None
