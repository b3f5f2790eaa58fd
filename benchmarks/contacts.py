"""Sequences in which limbs touch, and when they truly do: what benchmarks/intervals.py is scored against."""

import json
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np
import numpy.typing as npt
import yaml
from scipy.spatial import cKDTree

from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.figures import named

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
TOLERANCE = 2
NEAR = 0.01

# figure, motion, noise, and per contact: limb, target, first and last frame
CASES: dict[str, tuple[str, str, bool, tuple[tuple[str, str, int, int], ...]]] = {
    "hand on hip": ("human", "walk", True, (("hand_r", "hip_r", 12, 26),)),
    "other hand on hip": ("human", "wave", False, (("hand_l", "hip_l", 10, 24),)),
    "hand on knee": ("human", "squat", True, (("hand_l", "knee_l", 12, 24),)),
    "hand on head": ("human", "walk", False, (("hand_r", "head", 9, 20),)),
    "hand on elbow": ("human", "walk", False, (("hand_r", "elbow_l", 10, 21),)),
    "hand on chest": ("human", "squat", True, (("hand_r", "chest", 11, 21),)),
    "hand on shoulder": ("human", "wave", False, (("hand_l", "shoulder_r", 13, 25),)),
    "hip, then chest": ("human", "wave", False, (("hand_r", "hip_r", 8, 16), ("hand_l", "chest", 22, 30))),
    "foot on foot": ("human", "wave", False, (("toe_r", "toe_l", 11, 22),)),
    "foot on knee": ("human", "wave", False, (("toe_r", "knee_l", 12, 24),)),
    "paw on head": ("quadruped", "walk", False, (("claw_l", "head", 12, 24),)),
    "hind feet": ("quadruped", "look", False, (("toe_l", "toe_r", 10, 22),)),
    "fore paws": ("quadruped", "walk", False, (("claw_l", "claw_r", 12, 22),)),
    "tail on back": ("quadruped", "walk", False, (("tail_tip", "loin", 14, 28),)),
    "tail on hip": ("quadruped", "look", True, (("tail_tip", "hip_l", 9, 19),)),
    "arm on arm": ("starfish", "creep", False, (("end_1", "arm_2", 12, 24),)),
    "arms on disc": ("starfish", "creep", True, (("end_3", "disc", 6, 14), ("end_5", "arm_1", 22, 30))),
    "beak on shoulder": ("bird", "fly", False, (("beak", "shoulder_l", 12, 24),)),
    "wing on tail": ("bird", "fly", False, (("wing_l", "tail", 12, 24),)),
    "walk": ("human", "walk", True, ()),
    "wave": ("human", "wave", False, ()),
    "squat": ("human", "squat", False, ()),
    "trot": ("quadruped", "walk", False, ()),
    "fly": ("bird", "fly", False, ()),
    "creep": ("starfish", "creep", False, ()),
    "crawl": ("snake", "crawl", False, ()),
}


@dataclass
class Truth:
    """changes: transitions; tips: (frame, tip, xyz); touching: (frame,) frames near a contact; height: mesh unit."""

    changes: list[int]
    tips: Floats | None
    touching: npt.NDArray[np.bool_]
    height: float


def generated(name: str, vertices: int) -> tuple[Iterator[tuple[Floats, Ints]], Truth]:
    folder = files("kinetree.configs").joinpath("figures")
    figure, motion, noisy, touches = CASES[name]
    known = {p.name.removesuffix(".yaml"): yaml.safe_load(p.read_text("utf-8")) for p in folder.iterdir()}
    body = Body.of(
        named(figure, known),
        frames=36,
        motion=motion,
        vertices=vertices,
        noise=0.0007 if noisy else 0.0,
        contacts=[dict(zip(("limb", "target", "begin", "end"), touch, strict=True)) for touch in touches],
        seed=sorted(CASES).index(name),
    )
    truth = body.truth()
    frames = len(truth["positions"])
    spans = [(c["frames"][0], c["frames"][-1]) for c in truth["contacts"]]
    changes = [t for a, b in spans for t in (a - 1, b) if 0 <= t < frames - 1]
    tips = [i for i, j in enumerate(truth["joints"]) if j["kind"] == "tip" and not j["name"].startswith(("heel", "ear"))]
    touching = np.zeros(frames, dtype=np.bool_)
    for a, b in spans:
        touching[max(a - TOLERANCE, 0) : b + TOLERANCE + 1] = True
    meshes = (body.frame(t) for t in range(frames))
    return meshes, Truth(sorted(changes), np.array(truth["positions"])[:, tips], touching, float(truth["height"]))


def recorded(folder: Path, name: str) -> tuple[Iterator[tuple[Floats, Ints]], Truth]:
    stored = np.load(folder / f"{name}.npz")
    V, F, a, b = (stored[key] for key in ("vertices", "faces", "vertex_offsets", "face_offsets"))
    frames = len(a) - 1
    meshes = ((V[a[t] : a[t + 1]], F[b[t] : b[t + 1]] if len(b) > 2 else F) for t in range(frames))
    if not (folder / f"{name}.truth.json").exists():
        return meshes, Truth([], None, np.ones(frames, dtype=np.bool_), 1.0)
    truth = json.loads((folder / f"{name}.truth.json").read_text())
    tips = [i for i, j in enumerate(truth["joints"]) if j["kind"] == "tip"]
    state = arms_touching(folder / f"{name}-body.npz", float(truth["height"]))
    changes = np.flatnonzero((np.diff(state, axis=0) != 0).any(axis=1)).tolist()
    return meshes, Truth(changes, np.array(truth["positions"])[:, tips], state.any(axis=1), float(truth["height"]))


def arms_touching(path: Path, height: float) -> npt.NDArray[np.bool_]:
    """(frame, side) whether forearm or hand of the true body is near its trunk, head or legs; False without arms."""
    stored = np.load(path)
    V, a = stored["vertices"], stored["vertex_offsets"]
    names = [str(n).lower() for n in stored["weight_names"]]
    owner = np.argmax(stored["weights"], axis=1)
    arm = [np.array([n.startswith(s) and any(k in n for k in ("forearm", "hand", "finger", "thumb")) for n in names])
           for s in (("left", "lthumb"), ("right", "rthumb"))]  # fmt: skip
    upper = np.array([n.endswith("arm") and "fore" not in n for n in names])
    state = np.zeros((len(a) - 1, 2), dtype=np.bool_)
    for t in range(len(a) - 1):
        X = V[a[t] : a[t + 1]]
        for side in range(2):
            mine, rest = X[arm[side][owner]], X[~(arm[0] | arm[1] | upper)[owner]]
            state[t, side] = len(mine) > 0 and cKDTree(rest).query(mine)[0].min() < NEAR * height
    return state
