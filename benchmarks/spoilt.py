"""Clips of bodies, generated or of a file, and the ways in which they are spoilt. Lengths are shares of the height."""

import json
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any

import fast_simplification
import numpy as np
import trimesh
from accuracy import varied

from kinetree.tasks.numerics.arrays import Faces, Floats
from kinetree.tasks.numerics.input.source import read_npz
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.defects import punctured, roughened
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.trees import random_tree

MOTION_FRAMES = 36
"""Frames at the figure's own rate that a generated clip covers."""
HOLES = 3
"""Holes in every frame."""
CONTACT = {"limb": "hand_r", "target": "hip_r"}
Mesh = tuple[Floats, Faces]


@dataclass(frozen=True)
class Clip:
    """Meshes by frame number, and the true skeleton, whose positions are those of the frames 0, 1, 2, …"""

    name: str
    meshes: dict[int, Mesh]
    truth: dict[str, Any]
    body: Body | None = None

    @cached_property
    def height(self) -> float:
        """Of the body, in its own unit."""
        return float(self.truth["height"])

    @cached_property
    def tips(self) -> list[int]:
        """Joints that nothing hangs on, the farthest from the root last."""
        joints, X = self.truth["joints"], np.array(self.truth["positions"])[0]
        parents = {joint["parent"] for joint in joints}
        ends = [j for j, joint in enumerate(joints) if joint["name"] not in parents and j not in parents]
        return sorted(ends, key=lambda j: float(np.linalg.norm(X[j] - X[0])))

    def each(self, change: Callable[[int, Mesh], Mesh]) -> "Clip":
        """With every mesh changed."""
        return replace(self, meshes={t: change(t, mesh) for t, mesh in self.meshes.items()})


def generated(figure: str, seed: int, frames: int, vertices: int) -> Clip:
    """A body in motion, surfaced anew in every frame."""
    return of_body(f"{figure}-{seed}", _posed(figure, seed, frames, vertices))


def of_body(name: str, body: Body) -> Clip:
    """The clip that a generated body makes."""
    return Clip(name, {t: body.frame(t) for t in range(len(body.X))}, body.truth(), body)


def recorded(folder: Path, name: str) -> Clip:
    """A sequence of a file."""
    frames = read_npz(folder / f"{name}.npz")
    return Clip(name, {t: frames.mesh(t) for t in range(len(frames))}, json.loads((folder / f"{name}.truth.json").read_text()))


def _posed(figure: str, seed: int, frames: int, vertices: int, **options: Any) -> Body:
    drawn = random_tree(seed) if figure == "random" else Figure.of(varied(figure, seed))
    return Body.of(drawn, frames=frames, vertices=vertices, seed=seed, fps=drawn.fps * frames / MOTION_FRAMES, **options)


# ── what is done to a clip ──────────────────────────────────────────────────────────────────────────────────────────


def noise(clip: Clip, sigma: float) -> Clip:
    """Rough surfaces."""
    return clip.each(lambda t, m: (roughened(*m, sigma * clip.height, 0.1 * clip.height, _rng(clip, t)), m[1]))


def holes(clip: Clip, radius: float) -> Clip:
    """Three holes in every frame."""
    return clip.each(lambda t, m: _int32(punctured(*m, HOLES, radius * clip.height, _rng(clip, t))))


def frames(clip: Clip, share: float) -> Clip:
    """Some frames are not there; the first and the last stay."""
    inner = list(clip.meshes)[1:-1]
    lost = set(_rng(clip, 0).choice(inner, size=round(share * len(clip.meshes)), replace=False).tolist())
    return replace(clip, meshes={t: mesh for t, mesh in clip.meshes.items() if t not in lost})


def rate(clip: Clip, share: float) -> Clip:
    """Fewer frames a second."""
    step = round(1 / share)
    truth = {**clip.truth, "positions": clip.truth["positions"][::step], "fps": clip.truth["fps"] * share}
    return replace(clip, meshes=dict(enumerate(list(clip.meshes.values())[::step])), truth=truth)


def vertices(clip: Clip, share: float) -> Clip:
    """Coarser meshes."""
    return clip.each(lambda _, m: _int32(fast_simplification.simplify(m[0], m[1], target_reduction=1 - share)))


def limb(clip: Clip, count: int) -> Clip:
    """One limb is cut off in the middle of the clip."""
    joints, cut = clip.truth["joints"], set(_chain(clip)[:2])
    ends = np.array([[j, _index(joints, joint["parent"])] for j, joint in enumerate(joints) if joint["parent"] is not None])

    def without(t: int, mesh: Mesh) -> Mesh:
        if t not in _middle(clip, count):
            return mesh
        X = np.array(clip.truth["positions"][t])
        nearest = ends[np.argmin(_segment_distances(mesh[0], X[ends[:, 1]], X[ends[:, 0]]), axis=1), 0]
        return _kept(mesh, ~np.isin(nearest, list(cut))[mesh[1]].any(axis=1))

    return clip.each(without)


def contact(clip: Clip, count: int) -> Clip:
    """A hand grows together with the hip."""
    assert clip.body is not None
    middle, (figure, seed) = _middle(clip, count), clip.name.split("-")
    touch = {**CONTACT, "begin": middle.start, "end": middle.stop - 1, "ramp": 3}
    return of_body(clip.name, _posed(figure, int(seed), len(clip.meshes), clip.body.vertices, contacts=[touch]))


def bodies(clip: Clip, _: int) -> Clip:
    """Two of them, the second a few frames ahead."""
    numbers, width = list(clip.meshes), max(float(np.ptp(V[:, 0])) for V, _ in clip.meshes.values())

    def doubled(t: int, mesh: Mesh) -> Mesh:
        other = clip.meshes[numbers[(numbers.index(t) + 3) % len(numbers)]]
        return _joined(mesh, (other[0] + [1.5 * width, 0, 0], other[1]))

    return clip.each(doubled)


def carried(clip: Clip, radius: float) -> Clip:
    """A ball at the end of a limb."""
    ball, tip = trimesh.creation.icosphere(subdivisions=2, radius=radius * clip.height), clip.tips[-1]
    return clip.each(lambda t, m: _joined(m, (ball.vertices + clip.truth["positions"][t][tip], ball.faces)))


def clothes(clip: Clip, sigma: float) -> Clip:
    """Long waves over the surface, others in every frame."""
    return clip.each(lambda t, m: (m[0] + _waves(m[0], sigma * clip.height, clip.height / 3, _rng(clip, t)), m[1]))


KINDS: dict[str, tuple[Callable[[Clip, Any], Clip], tuple[float, ...]]] = {
    "none": (lambda clip, _: clip, (0,)),
    "noise": (noise, (0.00067, 0.0015, 0.003, 0.005)),
    "holes": (holes, (0.02, 0.04, 0.08)),
    "frames": (frames, (0.1, 0.3)),
    "rate": (rate, (0.5, 0.25)),
    "vertices": (vertices, (0.25, 0.05)),
    "limb": (limb, (1, 3, 6)),
    "contact": (contact, (2, 4, 8)),
    "bodies": (bodies, (2,)),
    "object": (carried, (0.05, 0.1)),
    "clothes": (clothes, (0.005, 0.01, 0.02)),
}


def _rng(clip: Clip, t: int) -> np.random.Generator:
    return np.random.default_rng([len(clip.meshes), t])


def _int32(mesh: tuple[Any, Any]) -> Mesh:
    return np.asarray(mesh[0], dtype=np.float64), np.asarray(mesh[1], dtype=np.int32)


def _middle(clip: Clip, count: int) -> range:
    begin = (len(clip.meshes) - int(count)) // 2
    return range(begin, begin + int(count))


def _index(joints: list[dict[str, Any]], parent: Any) -> int:
    return parent if isinstance(parent, int) else next(j for j, joint in enumerate(joints) if joint["name"] == parent)


def _chain(clip: Clip) -> list[int]:
    """Joints from the farthest tip towards the root."""
    joints, chain = clip.truth["joints"], [clip.tips[-1]]
    while joints[chain[-1]]["parent"] not in (None, -1):
        chain.append(_index(joints, joints[chain[-1]]["parent"]))
    return chain


def _segment_distances(V: Floats, A: Floats, B: Floats) -> Floats:
    """(vertex, bone)"""
    along = B - A
    share = np.einsum("vbx,bx->vb", V[:, None] - A, along) / np.maximum((along**2).sum(axis=1), 1e-12)
    return np.linalg.norm(V[:, None] - A - np.clip(share, 0, 1)[..., None] * along, axis=2)


def _kept(mesh: Mesh, faces: Any) -> Mesh:
    used, F = np.unique(mesh[1][faces], return_inverse=True)
    return _int32((mesh[0][used], F.reshape(-1, 3)))


def _joined(a: Mesh, b: Mesh) -> Mesh:
    return _int32((np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1] + len(a[0])])))


def _waves(V: Floats, sigma: float, wavelength: float, rng: np.random.Generator) -> Floats:
    """A smooth field of vectors of root mean square `sigma`."""
    k = rng.normal(size=(3, 16)) * (2 * np.pi / wavelength / np.sqrt(3.0))
    field = np.cos(V @ k + rng.uniform(0, 2 * np.pi, 16)) @ rng.normal(size=(16, 3))
    return sigma * field / np.sqrt((field**2).sum(axis=1).mean())
