"""Synthetic 3D video with a true skeleton: a figure, its motion, and the meshes a reconstruction would make of it.

Every frame is surfaced on its own grid, so vertices and connectivity differ from frame to frame, and topology changes
where limbs touch (the setting of 2014, §1). Frame t is a pure function of the arguments and t.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, NamedTuple

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.input.cameras import Cameras, camera_ring, silhouettes
from kinetree.tasks.numerics.input.synth.clothes import Tubes, dressed, tubes
from kinetree.tasks.numerics.input.synth.contacts import Contact, merging, touching
from kinetree.tasks.numerics.input.synth.defects import punctured, roughened
from kinetree.tasks.numerics.input.synth.descriptions import Motion, suggestion
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh
from kinetree.tasks.numerics.input.synth.implicit import Cones, extent, grid_values, nearest_limbs
from kinetree.tasks.numerics.input.synth.losses import Dropped
from kinetree.tasks.numerics.input.synth.motion import forward_kinematics, joint_rotations, true_joints
from kinetree.tasks.numerics.input.synth.skins import Skin
from kinetree.tasks.numerics.input.synth.softness import STEP, softened
from kinetree.tasks.numerics.input.synth.surfacing import spacing_for, surface

MOST_FRAMES = 1_000_000
"""Frames beyond which a clip is taken for a mistake."""
_SURFACE, _NOISE, _HOLES, _REST = range(4)
"""What a frame draws random numbers for, each from a stream of its own."""


class Volume(NamedTuple):
    """Signed distance on a grid, negative inside, clipped to ±band.

    field  : (x, y, z), point (i, j, k) at origin + voxel · (i, j, k); origin : (xyz); voxel, band : the figure's unit
    """

    field: Floats
    origin: Floats
    voxel: float
    band: float


@dataclass(frozen=True, eq=False)
class Body:
    """A figure in motion, ready to be surfaced frame by frame.

    R, G         : (frame, joint, 3, 3) rotations against the parent, and in the world
    X            : (frame, joint, xyz) true positions in the figure's unit
    noise        : root mean square along the normals, share of the height
    hole_size    : radius of a hole, share of the height
    connectivity : "new" in every frame, or "fixed": one mesh skinned to the joints
    sag, worn    : how far soft flesh stays behind (frame, limb, xyz), and the garments; None where there are none
    """

    figure: Figure
    flesh: Flesh
    fps: float
    vertices: int
    seed: int
    contacts: tuple[Contact, ...]
    dropped: tuple[Dropped, ...]
    noise: float
    holes: int
    hole_size: float
    connectivity: Literal["new", "fixed"]
    R: Floats
    X: Floats
    G: Floats
    sag: Floats | None
    worn: Tubes | None

    @classmethod
    def of(
        cls,
        figure: Figure,
        *,
        frames: int = 36,
        fps: float | None = None,
        motion: str | None = None,
        vertices: int = 3000,
        contacts: Sequence[Mapping[str, Any]] = (),
        dropped: Sequence[Mapping[str, Any]] = (),
        noise: float = 0.0,
        holes: int = 0,
        hole_size: float = 0.03,
        connectivity: Literal["new", "fixed"] = "new",
        seed: int = 0,
    ) -> Body:
        """Pose the figure in every frame; nothing is surfaced yet.

        fps      : frames per second of the clip, the figure's own when None; curves are functions of seconds
        contacts : {limb, target, begin, end, ramp, direction} each, see `contacts.Contact`
        dropped  : {limb, begin, end} each: everything beyond the joint `limb` is missing in these frames
        raises   : FigureError at a number out of range or a name that the figure does not know
        """
        _check(frames, fps, vertices, noise, holes, hole_size, connectivity, seed)
        if connectivity == "fixed" and (holes or dropped):
            raise FigureError("fixed connectivity can have neither holes nor dropped limbs: both would change its faces")
        flesh = Flesh.of(figure)
        rate = figure.fps if fps is None else float(fps)
        touches = tuple(Contact.of(figure, row, frames) for row in contacts)
        losses = tuple(Dropped.of(figure, flesh, row, frames) for row in dropped)
        if connectivity == "fixed" and figure.clothes:
            raise FigureError("fixed connectivity can have no clothes: they slide over the skin")
        seconds = np.arange(frames) / rate
        R, shift = joint_rotations(figure, figure.motion(motion), seconds)
        for touch in touches:
            R = touching(figure, flesh, touch, R, shift)
        X, G = forward_kinematics(figure.rest, figure.parents, R, shift)
        options = (rate, vertices, seed, touches, losses, float(noise), holes, float(hole_size), connectivity)
        return cls(figure, flesh, *options, R, X, G, *_loose(figure, flesh, figure.motion(motion), X, G, seconds))

    def frame(self, t: int) -> tuple[Floats, Ints]:
        """Mesh of frame t: (vertex, xyz) in the figure's unit, (face, corner) counter-clockwise seen from outside."""
        self._check_frame(t)
        if self.connectivity == "fixed":
            V, F = self.skin.posed(self._limbs(t), self.flesh, self.figure.rest, self.X[t], self.G[t]), self.skin.F
        else:
            V, F = surface(self._cones(t), self._first_spacing, self._rng(_SURFACE, t), self.vertices)
        if self.noise:
            height = self.figure.height
            V = roughened(V, F, self.noise * height, 0.1 * height, self._rng(_NOISE, t))
        if self.holes:
            V, F = punctured(V, F, self.holes, self.hole_size * self.figure.height, self._rng(_HOLES, t))
        return V, F

    def truth(self) -> dict[str, Any]:
        """The true skeleton as plain lists and numbers: joints, positions, rigid parts, contacts, dropped limbs.

        `turns_deg` is the largest angle between two frames of the joint's rotation against its parent; `part` the
        index, in `parts`, of the rigid part that the joint carries (null at a tip).
        """
        joints, parts = self._true_joints
        name = self.figure.names
        return {
            "unit": self.figure.unit,
            "height": self.figure.height,
            "fps": self.fps,
            "joints": [dict(joint) for joint in joints],
            "positions": self.X.tolist(),
            "parts": [list(part) for part in parts],
            "contacts": [
                {"limb": name[c.limb], "target": name[c.target], "frames": list(range(c.begin, c.end + 1))}
                for c in self.contacts
            ],
            "dropped": [{"limb": name[d.joint], "frames": list(range(d.begin, d.end + 1))} for d in self.dropped],
        }

    def parts(self, t: int, V: Floats) -> Ints:
        """(vertex,) true rigid part of points near the surface of frame t: that of the nearest limb; see `truth`."""
        self._check_frame(t)
        carried = [joint["part"] for joint in self._true_joints[0]]
        of_limb = np.array([carried[p] for p in self.flesh.parent], dtype=np.int64)
        return np.asarray(of_limb[nearest_limbs(self._limbs(t), V)], dtype=np.int64)

    def volume(self, t: int, voxel: float | None = None) -> Volume:
        """Clipped signed distance of frame t on a grid that is the same in every frame of the clip.

        voxel : grid spacing in the figure's unit; the height / 100 when None
        """
        self._check_frame(t)
        step = self.figure.height / 100.0 if voxel is None else float(voxel)
        if not step > 0.0:
            raise FigureError(f"voxel is {voxel!r}, expected a length above 0")
        low, high = self._box
        origin = low - 2.0 * step
        nx, ny, nz = (int(n) for n in np.ceil((high - low) / step) + 5)
        return Volume(grid_values(self._cones(t), origin, step, (nx, ny, nz), 4.0 * step), origin, step, 4.0 * step)

    def cameras(self, count: int = 15, size: tuple[int, int] = (480, 480), elevation: float = 15.0) -> Cameras:
        """A ring of cameras that sees the whole clip (2009, §5: fifteen around the figure); `size` is (rows, columns)."""
        low, high = self._box
        return camera_ring(count, 0.5 * (low + high), 0.5 * float(np.linalg.norm(high - low)), size, elevation)

    def silhouettes(self, t: int, cameras: Cameras) -> Flags:
        """(camera, row, column) what the cameras see of frame t's mesh."""
        return silhouettes(*self.frame(t), cameras)

    @cached_property
    def skin(self) -> Skin:
        """The mesh of fixed connectivity: surfaced once at rest, with weights from the blend."""
        identity = np.tile(np.eye(3), (len(self.figure.joints), 1, 1))
        cones = self.flesh.at(self.figure.rest, identity)
        V, F = surface(cones, self._first_spacing, self._rng(_REST, 0), self.vertices)
        soft = self.figure.softness
        return Skin.of(self.flesh, self.figure.rest, V, F, *([] if soft is None else [soft.skin]))

    def weights(self) -> Floats:
        """(vertex, joint) true skinning weights of the fixed connectivity; a tip moves nothing."""
        W = np.zeros((len(self.skin.V), len(self.figure.joints)))
        for b, p in enumerate(self.flesh.parent):
            W[:, p] += self.skin.weights[:, b]
        return W

    @cached_property
    def _true_joints(self) -> tuple[list[dict[str, Any]], list[list[str]]]:
        """What `true_joints` gives: it compares every frame with every other."""
        return true_joints(self.figure, self.R)

    @cached_property
    def _box(self) -> tuple[Floats, Floats]:
        corners = [extent(self._dressed(t, self._soft(t, None))) for t in range(len(self.X))]
        return np.min([low for low, _ in corners], axis=0), np.max([high for _, high in corners], axis=0)

    @cached_property
    def _first_spacing(self) -> float:
        return spacing_for(self.flesh.at(self.X[0], self.G[0]), self.vertices)

    def _cones(self, t: int) -> Cones:
        """What is surfaced: the limbs and the clothes on them."""
        return self._dressed(t, self._limbs(t))

    def _dressed(self, t: int, cones: Cones) -> Cones:
        return cones if self.worn is None else dressed(cones, self.worn, t)

    def _soft(self, t: int, missing: Flags | None) -> Cones:
        """The limbs of a frame before any of them merge."""
        cones, soft = self.flesh.at(self.X[t], self.G[t], missing), self.figure.softness
        if soft is None or self.sag is None:
            return cones
        return softened(cones, self.sag[t], soft.swelling((self.flesh.parent, self.flesh.child), self.R[t : t + 1])[0])

    def _limbs(self, t: int) -> Cones:
        """The limbs without clothes."""
        cones = self._soft(t, self._missing(t))
        for contact in self.contacts:
            if contact.begin <= t <= contact.end:
                cones = merging(self.figure, self.flesh, contact, cones)
        return cones

    def _missing(self, t: int) -> Flags | None:
        lost = [d.limbs for d in self.dropped if d.begin <= t <= d.end]
        return np.any(lost, axis=0) if lost else None

    def _rng(self, purpose: int, t: int) -> np.random.Generator:
        return np.random.default_rng([self.seed, purpose, t])

    def _check_frame(self, t: int) -> None:
        if not 0 <= t < len(self.X):
            raise FigureError(f"frame {t} was asked for, but the clip has frames 0 to {len(self.X) - 1}")


def _loose(
    figure: Figure, flesh: Flesh, motion: Motion, X: Floats, G: Floats, seconds: Floats
) -> tuple[Floats | None, Tubes | None]:
    """How far soft flesh stays behind, and the garments, from the motion around every moment, whatever the frame rate.

    X, G : (frame, joint, xyz) positions and (frame, joint, 3, 3) world rotations at these seconds
    """

    def posed(times: Floats) -> tuple[Floats, Floats]:
        return forward_kinematics(figure.rest, figure.parents, *joint_rotations(figure, motion, times))

    def fleshed(X: Floats, G: Floats) -> Floats:
        return X + np.einsum("tjxy,jy->tjx", G, figure.flesh)

    sag = worn = None
    if figure.softness is not None:
        ends, radius = (flesh.parent, flesh.child), flesh.table.mean(axis=1)
        sag = figure.softness.sag(ends, radius, *(posed(seconds + k * STEP)[0] for k in (-1, 0, 1)))
    if figure.clothes:
        earlier = [fleshed(*posed(seconds - g.lag)) for g in figure.clothes]
        rest, now = figure.rest + figure.flesh, fleshed(X, G)
        worn = tubes(figure.clothes, rest, now, G, earlier, seconds, flesh.table.shape[1])
    return sag, worn


def _check(
    frames: int, fps: float | None, vertices: int, noise: float, holes: int, hole_size: float, connectivity: str, seed: int
) -> None:
    """Refuse numbers out of range; the message names the setting, what was found and what was expected."""
    for name, value, least in (("frames", frames, 1), ("vertices", vertices, 100), ("holes", holes, 0), ("seed", seed, 0)):
        if isinstance(value, bool) or not isinstance(value, int) or value < least:
            raise FigureError(f"{name} is {value!r}, expected a whole number of at least {least}")
    for name, count, most in (("frames", frames, MOST_FRAMES), ("holes", holes, vertices // 10)):
        if count > most:
            raise FigureError(f"{name} is {count}, expected at most {most}" + (", a tenth of the vertices" * (name == "holes")))
    for name, share in (("noise", noise), ("hole_size", hole_size)):
        if not isinstance(share, int | float) or not 0.0 <= share < 0.5:
            raise FigureError(f"{name} is {share!r}, expected a share of the height, from 0 to below 0.5")
    if fps is not None and (not isinstance(fps, int | float) or not 0.0 < fps < np.inf):
        raise FigureError(f"fps is {fps!r}, expected frames per second above 0")
    if connectivity not in ("new", "fixed"):
        raise FigureError(f"connectivity is {connectivity!r}{suggestion(connectivity, ('new', 'fixed'))}")
