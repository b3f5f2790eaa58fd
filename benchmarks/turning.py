"""True trajectories of an observed mesh, and how far each true joint turns in an alignment."""

import json
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from kinetree.tasks.numerics.geometry.closest_point import projected

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

CLEAR = 0.6  # a vertex belongs to the part that holds this much of its skinning weight
FEWEST = 8  # vertices of a part whose rotation is measured


@dataclass(frozen=True)
class Turn:
    """A joint: share of the true turning over all frames (1 is all of it), and of its largest angle, in degrees."""

    joint: str
    share: float
    peak: float
    degrees: float


@dataclass(frozen=True)
class Truth:
    """x (frame, vertex, xyz) of the reference's vertices, their parts, and (joint, child part, parent part)."""

    x: Floats
    part: list[str]
    label: Ints
    joints: list[tuple[str, str, str]]
    height: float

    @classmethod
    def of(cls, folder: Path, name: str, V: Floats, frame: int) -> "Truth":
        """Attach every vertex of an observed mesh to the closest point of the true body in its frame and follow it."""
        body = np.load(folder / f"{name}-body.npz")
        truth = json.loads((folder / f"{name}.truth.json").read_text())
        offsets, F = body["vertex_offsets"], body["faces"].astype(np.int64)
        X = np.stack([body["vertices"][a:b].astype(np.float64) for a, b in pairwise(offsets)])
        on = projected(V, X[frame], F)
        x = np.einsum("vk,tvkx->tvx", on.share, X[:, F[on.face]])
        W = np.einsum("vk,vkj->vj", on.share, body["weights"][F[on.face]])
        part, W, joints = _parts([str(n) for n in body["weight_names"]], W, truth["joints"])
        return cls(x, part, np.where(W.max(axis=1) > CLEAR, W.argmax(axis=1), -1), joints, float(truth["height"]))

    def turns(self, y: Floats, reference: int) -> list[Turn]:
        """Each scored joint's turning in y (frame, vertex, xyz) against the truth."""
        mine, true = self._rotations(y, reference), self._rotations(self.x, reference)
        out = []
        for joint, child, parent in self.joints:
            if child in mine and parent in mine:
                a, b = (r[parent].transpose(0, 2, 1) @ r[child] for r in (mine, true))
                out.append(Turn(joint, *_compared(a, b)))
        return out

    def _rotations(self, y: Floats, reference: int) -> dict[str, Floats]:
        """(frame, 3, 3) of every part against the reference, by least squares (Kabsch)."""
        out = {}
        for number, name in enumerate(self.part):
            member = np.flatnonzero(self.label == number)
            if len(member) >= FEWEST:
                P, Q = self.x[reference][member], y[:, member]
                C = np.einsum("tvx,vy->txy", Q - Q.mean(axis=1, keepdims=True), P - P.mean(axis=0))
                U, _, Vt = np.linalg.svd(C)
                U[:, :, 2] *= np.sign(np.linalg.det(U @ Vt))[:, None]
                out[name] = U @ Vt
        return out


def _compared(a: Floats, b: Floats) -> tuple[float, float, float]:
    """Slope of the turning vectors over frames, share of the largest true angle between two frames, that angle."""
    U, _, Vt = np.linalg.svd(b.mean(axis=0))
    middle = (U @ Vt).T
    v, w = (Rotation.from_matrix(middle @ r).as_rotvec() for r in (a, b))
    v, w = v - v.mean(axis=0), w - w.mean(axis=0)
    angle = np.arccos(np.clip((np.einsum("tyx,uyx->tu", b, b) - 1) / 2, -1, 1))
    t, u = np.unravel_index(angle.argmax(), angle.shape)
    peak = np.arccos(np.clip((np.sum(a[t] * a[u]) - 1) / 2, -1, 1))
    return float((v * w).sum() / max((w * w).sum(), 1e-12)), float(peak / angle[t, u]), float(np.degrees(angle[t, u]))


def _parts(
    names: list[str], W: Floats, joints: list[dict[str, object]]
) -> tuple[list[str], Floats, list[tuple[str, str, str]]]:
    """Parts that move, their weights, and between which two every scored joint lies.

    Weights are named by the joint at the part's near end, or `bone_a_b` by both ends; what does not turn against its
    parent belongs to it.
    """
    parent = {str(j["name"]): j["parent"] for j in joints}
    scored = [str(j["name"]) for j in joints if j["scored"]]
    if all(n.startswith("bone_") for n in names):
        ends = [n.split("_")[1:] for n in names]
        part = [f"j{b}" for _, b in ends]
        return part, W, [(f"{j}→{c}", c, j) for j in scored for c in part if parent[c] == j and j in part]
    still = {str(j["name"]): float(str(j["turns_deg"])) < 1.0 and j["parent"] is not None for j in joints}
    root: dict[str, str] = {}
    for name, above in parent.items():
        root[name] = root[str(above)] if still[name] else name
    merged = np.zeros_like(W)
    for k, name in enumerate(names):
        merged[:, names.index(root[name])] += W[:, k]
    moving = {names[k] for k in np.flatnonzero((merged > CLEAR).sum(axis=0) >= FEWEST)}
    out = []
    for joint in scored:
        above = root[str(parent[joint])]
        # a link without a surface of its own turns with what lies above it
        while above not in moving and parent[above] is not None:
            above = root[str(parent[above])]
        out.append((joint, joint, above))
    return names, merged, out
