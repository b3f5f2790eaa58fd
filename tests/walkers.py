"""Generated bodies as joints over time, without a surface: what is named is known."""

from importlib.resources import files
from typing import NamedTuple

import numpy as np
import yaml

from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics, joint_rotations
from kinetree.tasks.numerics.structure.limb_motion import Motion

FIGURES = files("kinetree.configs") / "figures"
HUMAN = {"hips": "pelvis", "heel_l": None, "heel_r": None, "head_top": "head_end", "toe_l": "foot_end_l", "toe_r": "foot_end_r",
         "hand_l": "hand_end_l", "hand_r": "hand_end_r"}  # fmt: skip
"""True names of the generated human that differ from those of `anatomical_names`; None where there is no such name."""
QUADRUPED = {
    "pelvis": "pelvis", "loin": "spine", "muzzle": "head_end", "tail_tip": "tail_end", "ear_l": None, "ear_r": None,
    **{f"{old}_{side}": f"{new}_{side}" for side in "lr" for old, new in {
        "hip": "hind_hip", "stifle": "hind_knee", "hock": "hind_ankle", "foot": "hind_toe", "toe": "hind_foot_end",
        "shoulder": "fore_shoulder", "elbow": "fore_elbow", "wrist": "fore_wrist", "paw": "fore_toe", "claw": "fore_foot_end",
    }.items()},
}  # fmt: skip


class Walker(NamedTuple):
    """The joints of a figure over time, which of them are ends, and their true names."""

    motion: Motion
    ends: np.ndarray
    names: list[str]


def walker(name: str, motion: str | None = None, seed: int = 0, frames: int = 24) -> Walker:
    """A figure that ships, with other proportions for other seeds; ends lie at the skin, as they are found."""
    return moved(shipped(name), motion, seed, frames)


def shipped(name: str) -> Figure:
    """A figure that ships."""
    return Figure.of(yaml.safe_load((FIGURES / f"{name}.yaml").read_text("utf-8")))


def beast(*kind: str) -> Figure:
    """The quadruped with a large pair of ears, with horns, with tusks, with a long nose, or with a trunk that swings."""
    figure = yaml.safe_load((FIGURES / "quadruped.yaml").read_text("utf-8"))
    joint = {j["name"]: j for j in figure["joints"]}
    for side, x in (("l", 1), ("r", -1)):
        if "ears" in kind:
            joint[f"ear_{side}"]["position"] = [x * 230, -360, 960]
        for name, place in {"tusk": [x * 90, -640, 620], "horn": [x * 150, -330, 1080]}.items():
            if f"{name}s" in kind:
                figure["joints"].append({"name": f"{name}_{side}", "parent": "head", "position": place, "radii": [25, 15]})
    if "nose" in kind:
        joint["muzzle"]["position"] = [0, -800, 690]
    if "trunk" in kind:
        joint["muzzle"]["position"] = [0, -560, 640]
        figure["joints"].append({"name": "trunk_tip", "parent": "muzzle", "position": [0, -600, 250], "radii": [30, 20]})
        for curves in figure["motions"].values():
            curves["muzzle"] = [{"axis": [1, 0, 0], "amplitude": 25, "frequency": 0.7}]
    return Figure.of(figure)


def moved(figure: Figure, motion: str | None = None, seed: int = 0, frames: int = 24) -> Walker:
    """A figure over one and a half seconds."""
    rng = np.random.default_rng(seed)
    parents = figure.parents
    ends = np.array([j not in parents for j in range(len(parents))])
    rest = figure.rest * (rng.uniform(0.88, 1.12, 3) if seed else 1.0)
    for j in np.flatnonzero(ends):
        along = rest[j] - rest[parents[j]]
        rest[j] += along / np.linalg.norm(along) * figure.joints[j].radii[-1]
    R, shift = joint_rotations(figure, figure.motion(motion), np.linspace(0.0, 1.4, frames))
    X, G = forward_kinematics(rest, parents, R, shift)
    G = np.where(ends[None, :, None, None], G[:, np.maximum(parents, 0)], G)
    return Walker(Motion(rest, parents, X, G, np.array([0.0, 0.0, 1.0])), ends, figure.names)


def turned(motion: Motion, Q: np.ndarray, scale: float = 1.0) -> Motion:
    """The same body in other coordinates; a mirrored one where Q mirrors."""
    return Motion(scale * motion.rest @ Q.T, motion.parents, scale * motion.X @ Q.T, Q @ motion.R @ Q.T, Q @ motion.up)


def without(body: Walker, *names: str) -> Walker:
    """A body in which some joints were not found: what they carried follows their parents."""
    old = body.motion
    stay = [j for j, name in enumerate(body.names) if name not in names]
    number = {j: n for n, j in enumerate(stay)}
    above = []
    for j in stay:
        p = int(old.parents[j])
        while p >= 0 and p not in number:
            p = int(old.parents[p])
        above.append(number.get(p, -1))
    motion = Motion(old.rest[stay], np.array(above), old.X[:, stay], old.R[:, stay], old.up)
    return Walker(motion, body.ends[stay], [body.names[j] for j in stay])
