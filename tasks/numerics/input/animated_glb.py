"""An animated GLB as a sequence of meshes: nodes that move, morph targets and skins, as a viewer shows them.

Source: Khronos Group, glTF 2.0 Specification, Sec. 3.5.3 (transformations), 3.7.2 (meshes), 3.7.3 (skins), 3.11 (animations).
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetree.errors import SourceError
from kinetree.tasks.numerics.arrays import Faces, Floats, Ints
from kinetree.tasks.numerics.input.formats import checked
from kinetree.tasks.numerics.input.gltf import Gltf
from kinetree.tasks.numerics.input.gltf_channel import Channel, rotation_matrix
from kinetree.tasks.numerics.input.unpacked import bomb

_DENSE_KEYS = 1 / 12
"""Keys no further apart than this (seconds) …"""
_EVEN_KEYS = 8
"""… or this many at equal distances were sampled, and their rate is the animation's; …"""
_RATE = 24.0
"""… others were set by hand, and are read at this many frames a second. None is read faster than …"""
_MOST_RATE = 240.0
"""… this."""
_MOST_FRAMES = 100_000
_MOST_VERTICES = 50_000_000
_MOST_BYTES = 2**31
"""Of all morph targets as numbers: those of a body of 100,000 vertices for half a minute."""
_MOST_DEPTH = 1000
_WIDTH = {"translation": 3, "rotation": 4, "scale": 3}
_REST: Mapping[str, Sequence[float]] = {"translation": (0, 0, 0), "rotation": (0, 0, 0, 1), "scale": (1, 1, 1)}


@dataclass(frozen=True)
class _Piece:
    """One primitive where one node shows it.

    V, F    : (vertex, xyz), (face, corner) at rest
    targets : (target, vertex, xyz) what is added for each morph target's weight
    joints  : (vertex, influence) rows of `skin`, weights likewise; none where no skin moves it
    skin    : the nodes that move it, and inverse : (joint, 4, 4) from the mesh at rest to each
    """

    node: int
    V: Floats
    F: Ints
    targets: Floats
    weights_at_rest: Floats
    joints: Ints
    weights: Floats
    skin: Sequence[int]
    inverse: Floats


class AnimatedGlb:
    """The frames of an animated GLB in metres; every frame has the same faces.

    fps  : frames a second; None where morph targets are the frames
    unit : m, as glTF has it
    """

    unit = "m"
    fps: float | None
    _times: Floats

    def __init__(self, raw: bytes, name: str, clip: str = "", *, targets_are_frames: bool = False) -> None:
        """From the bytes of a file.

        raw, name          : the bytes, and what messages call the file
        clip               : the animation's name; the first where empty
        targets_are_frames : each morph target is a frame, and no animation is read (Universal Volumetric 2)
        """
        self.name = name
        self._gltf = Gltf.of(raw)
        self._stored, self._unfolded = len(raw), 0
        self._nodes = self._gltf.items("nodes")
        self._parents = self._order()
        self._channels = [] if targets_are_frames else self._channels_of(self._animation(clip))
        self._pieces = self._pieces_shown()
        self._targets = self._targets_of_frames() if targets_are_frames else 0
        self.fps, self._times = self._frames() if self._channels else (None, np.zeros(self._targets))

    def __len__(self) -> int:
        return len(self._times)

    def mesh(self, t: int) -> tuple[Floats, Faces]:
        """V (vertex, xyz) and F (face, corner) of frame t; SourceError where there is none, MeshError as `checked`."""
        if not 0 <= t < len(self):
            raise SourceError(f"{self.name}: there is no frame {t}; frames are 0 to {len(self) - 1}")
        world, weights = self._posed(self._times[t])
        V, F, begin = [], [], 0
        for piece in self._pieces:
            X = piece.V
            if self._targets:
                X = X + piece.targets[t]
            elif len(piece.targets):
                w = weights.get(piece.node, piece.weights_at_rest)
                n = min(len(w), len(piece.targets))
                X = X + np.tensordot(w[:n], piece.targets[:n], 1)
            flips = False
            if len(piece.skin):
                M = np.stack([world[j] for j in piece.skin]) @ piece.inverse
                moved = np.zeros_like(X)
                for i in range(piece.joints.shape[1]):
                    own = M[piece.joints[:, i]]
                    moved += piece.weights[:, i, None] * (np.einsum("vij,vj->vi", own[:, :3, :3], X) + own[:, :3, 3])
                X = moved
            else:
                M = world[piece.node]
                X = X @ M[:3, :3].T + M[:3, 3]
                flips = bool(np.linalg.det(M[:3, :3]) < 0)
            V.append(X)
            # a mirror turns faces inside out unless their corners are turned too
            F.append((piece.F[:, ::-1] if flips else piece.F) + begin)
            begin += len(X)
        return checked(np.concatenate(V), np.concatenate(F), f"{self.name}, frame {t}")

    def _array(self, index: Any) -> Floats:
        """An accessor's numbers; raises SourceError where all arrays together are too large for the bytes that are there."""
        self._unfolded += self._gltf.size(index)
        if why := bomb(self._stored, self._unfolded):
            raise SourceError(f"{self.name}: its arrays: {why}")
        return self._gltf.array(index)

    def _order(self) -> dict[int, int | None]:
        """The parent of every node that the scene shows, parents before their children."""
        scenes = self._gltf.items("scenes")
        children = {c for node in self._nodes for c in node.get("children", [])}
        roots = self._gltf.item("scenes", self._gltf.document.get("scene", 0)).get("nodes", []) if scenes else None
        waiting: list[tuple[int, int | None, int]] = [
            (i, None, 0) for i in (roots if roots is not None else set(range(len(self._nodes))) - children)
        ]
        parents: dict[int, int | None] = {}
        while waiting:
            i, parent, depth = waiting.pop()
            node = self._gltf.item("nodes", i)
            if i in parents or depth > _MOST_DEPTH:
                raise SourceError(f"{self.name}: its nodes are no tree; the file is damaged")
            parents[i] = parent
            waiting += [(c, i, depth + 1) for c in node.get("children", [])]
        return parents

    def _animation(self, clip: str) -> Mapping[str, Any]:
        """The animation of this name, or the first."""
        there = self._gltf.items("animations")
        names = [str(a.get("name", k)) for k, a in enumerate(there)]
        if not there:
            raise SourceError(f"{self.name}: one mesh without animation, not a sequence; give the folder of the frames' files")
        if clip and clip not in names:
            raise SourceError(f"{self.name}: source.clip {clip}: there is {', '.join(names)[:300]}")
        return there[names.index(clip) if clip else 0]

    def _channels_of(self, animation: Mapping[str, Any]) -> list[Channel]:
        samplers = animation.get("samplers", [])
        channels = []
        for channel in animation.get("channels", []):
            target, k = channel.get("target", {}), channel.get("sampler")
            if target.get("node") not in self._parents or target.get("path") not in ("weights", *_WIDTH):
                continue  # a light, a camera, or a node that is not shown
            if not isinstance(k, int) or not 0 <= k < len(samplers):
                raise SourceError(f"{self.name}: an animation names sampler {k!r}, which is not there; the file is damaged")
            times, values = self._array(samplers[k].get("input")), self._array(samplers[k].get("output"))
            way = str(samplers[k].get("interpolation", "LINEAR"))
            rows = (len(times), 3) if way == "CUBICSPLINE" else (len(times),)
            width = _WIDTH.get(target["path"], values.size // max(int(np.prod(rows)), 1))
            if times.ndim != 1 or not len(times) or (np.diff(times) <= 0).any() or values.size != np.prod(rows) * width:
                raise SourceError(f"{self.name}: the keys of an animation do not fit its times; the file is damaged")
            if not np.isfinite(times).all():
                raise SourceError(f"{self.name}: an animation has times without end; the file is damaged")
            channels.append(Channel(target["node"], target["path"], times, values.reshape(*rows, width), way))
        if not channels:
            raise SourceError(f"{self.name}: its animation moves nothing that is shown")
        return channels

    def _frames(self) -> tuple[float, Floats]:
        """Frames a second, and the time of each frame: those of the densest channel, where it is sampled."""
        densest = max((c.times for c in self._channels), key=len)
        steps = np.diff(densest)
        step = float(np.median(steps)) if len(steps) else np.inf
        is_even = len(densest) >= _EVEN_KEYS and bool((np.abs(steps - step) < 0.01 * step).all())
        rate = min(1 / step, _MOST_RATE) if is_even or step <= _DENSE_KEYS else _RATE
        if abs(rate - round(rate)) < 0.01 * rate:
            rate = float(round(rate))
        first, last = min(c.times[0] for c in self._channels), max(c.times[-1] for c in self._channels)
        if (last - first) * rate > _MOST_FRAMES:
            raise SourceError(
                f"{self.name}: lasts {last - first:.3g} s, more than {_MOST_FRAMES} frames; export a shorter clip"
            )
        frames = round(float((last - first) * rate)) + 1
        return rate, first + np.arange(frames) / rate

    def _targets_of_frames(self) -> int:
        """How many morph targets each piece has; raises SourceError where there is none, or they differ."""
        counts = {len(piece.targets) for piece in self._pieces}
        if counts == {0} or len(counts) > 1:
            different_counts = " and ".join(map(str, sorted(counts)))
            raise SourceError(f"{self.name}: its meshes have {different_counts} morph targets, which are no frames")
        if (count := counts.pop()) > _MOST_FRAMES:
            raise SourceError(f"{self.name}: {count} morph targets, more than {_MOST_FRAMES} frames; export a shorter segment")
        return count

    def _posed(self, t: float) -> tuple[dict[int, Floats], dict[int, Floats]]:
        """The matrix of every node in the scene, and weights of morph targets, at a time."""
        now = {(c.node, c.path): c.at(t) for c in self._channels}
        world: dict[int, Floats] = {}
        for i, parent in self._parents.items():
            node = self._nodes[i]
            moves = any((i, path) in now for path in _WIDTH)
            if "matrix" in node and not moves:
                local = _numbers(node["matrix"], 16, self.name).reshape(4, 4).T
            else:
                own = {p: now.get((i, p), _numbers(node.get(p, _REST[p]), n, self.name)) for p, n in _WIDTH.items()}
                local = np.eye(4)
                local[:3, :3] = rotation_matrix(own["rotation"]) * own["scale"]
                local[:3, 3] = own["translation"]
            world[i] = local if parent is None else world[parent] @ local
        return world, {node: value for (node, path), value in now.items() if path == "weights"}

    def _pieces_shown(self) -> list[_Piece]:
        pieces, vertices, size = [], 0, 0
        for i in self._parents:
            node = self._nodes[i]
            if "mesh" not in node:
                continue
            mesh = self._gltf.item("meshes", node["mesh"])
            for primitive in mesh.get("primitives", []):
                if primitive.get("mode", 4) != 4:
                    continue
                pieces.append(self._piece(i, node, mesh, primitive))
                vertices += len(pieces[-1].V)
                size += pieces[-1].targets.nbytes
                if vertices > _MOST_VERTICES:
                    raise SourceError(f"{self.name}: its scene unfolds to more than {_MOST_VERTICES} vertices")
                self._refuse_beyond(size)
        if not pieces:
            raise SourceError(f"{self.name}: shows no triangles; a surface is needed")
        return pieces

    def _piece(self, i: int, node: Mapping[str, Any], mesh: Mapping[str, Any], primitive: Mapping[str, Any]) -> _Piece:
        attributes = primitive.get("attributes", {})
        V = self._array(attributes.get("POSITION"))
        corners = self._array(primitive["indices"]) if "indices" in primitive else np.arange(len(V), dtype=np.float64)
        if V.ndim != 2 or V.shape[1] != 3 or corners.ndim != 1 or len(corners) % 3:
            raise SourceError(f"{self.name}: a mesh is not made of triangles in space; the file is damaged")
        V, F = checked(V, corners.astype(np.int64).reshape(-1, 3), self.name)
        target_attributes = primitive.get("targets", [])
        self._refuse_beyond(len(target_attributes) * V.nbytes)  # a target without positions takes three bytes of the file
        targets = [self._array(t["POSITION"]) if "POSITION" in t else np.zeros_like(V) for t in target_attributes]
        if any(t.shape != V.shape for t in targets):
            raise SourceError(f"{self.name}: a morph target has not as many vertices as its mesh; the file is damaged")
        at_rest = node.get("weights", mesh.get("weights", [0.0] * len(targets)))
        joints, weights, skin, inverse = self._skin(node, attributes, len(V))
        return _Piece(
            i, V, F.astype(np.int64), np.array(targets).reshape(-1, len(V), 3), _numbers(at_rest, None, self.name),
            joints, weights, skin, inverse,
        )  # fmt: skip

    def _refuse_beyond(self, size: int) -> None:
        """Raises SourceError where morph targets take more bytes than they may."""
        if size > _MOST_BYTES:
            raise SourceError(f"{self.name}: its morph targets unfold to {size} bytes, more than {_MOST_BYTES}; export fewer")

    def _skin(
        self, node: Mapping[str, Any], attributes: Mapping[str, Any], n: int
    ) -> tuple[Ints, Floats, Sequence[int], Floats]:
        """Joints and weights (vertex, influence) of n vertices, the joints' nodes, and their inverse bind matrices."""
        sets = [k for k in range(8) if f"JOINTS_{k}" in attributes and f"WEIGHTS_{k}" in attributes]
        if "skin" not in node or not sets:
            return np.zeros((n, 0), np.int64), np.zeros((n, 0)), (), np.zeros((0, 4, 4))
        skin = self._gltf.item("skins", node["skin"])
        nodes = skin.get("joints", [])
        joints = np.concatenate([self._array(attributes[f"JOINTS_{k}"]) for k in sets], axis=1).astype(np.int64)
        weights = np.concatenate([self._array(attributes[f"WEIGHTS_{k}"]) for k in sets], axis=1)
        inverse = (
            self._array(skin["inverseBindMatrices"])
            if "inverseBindMatrices" in skin
            else np.broadcast_to(np.eye(4), (len(nodes), 4, 4))
        )
        fits = joints.shape == weights.shape and len(joints) == n and inverse.shape == (len(nodes), 4, 4)
        if not fits or any(j not in self._parents for j in nodes) or (joints >= len(nodes)).any():
            raise SourceError(
                f"{self.name}: a skin does not fit its mesh, or names joints that are not shown; the file is damaged"
            )
        total = weights.sum(axis=1, keepdims=True)
        return joints, np.where(total > 0, weights / np.maximum(total, 1e-12), np.eye(1, weights.shape[1])), nodes, inverse


def _numbers(value: Any, n: int | None, name: str) -> Floats:
    """A list of n numbers; raises SourceError where it is none."""
    try:
        numbers = np.array(value, dtype=np.float64)
    except (TypeError, ValueError):
        numbers = np.array(np.nan)
    if numbers.ndim != 1 or (n is not None and len(numbers) != n) or not np.isfinite(numbers).all():
        raise SourceError(f"{name}: {str(value)[:40]} is no list of {n or 'some'} numbers; the file is damaged")
    return numbers
