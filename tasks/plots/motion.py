"""How every joint turns over time, and how far a bone's length varies before it is fixed (2014, Sec. 6.3)."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from kinetree.schemas.alignment import Alignment
from kinetree.schemas.array import Floats
from kinetree.schemas.skeleton import Skeleton
from kinetree.tasks.plots.drawing import COLOURS, Fetch, blank

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COLUMNS = 4
FEWEST = 3
"""Vertices without which a part's motion is not known."""


def angles(fetch: Fetch, frames: list[int], up: int | None = None) -> "Figure":
    """How far every joint has turned against its parent since the reference pose, a picture a joint."""
    found: Skeleton = fetch("skeleton")
    inner = [j for j, kind in enumerate(found.kinds) if kind == "joint"]
    if not inner:
        figure, axes = blank(6.0, 1.2)
        axes.annotate("no joints", (0.5, 0.5), xycoords="axes fraction", ha="center")
        axes.set_axis_off()
        return figure
    rows = -(-len(inner) // COLUMNS)
    figure, grid = blank(11.0, 1.5 * rows + 0.6, columns=COLUMNS, rows=rows)
    turned = turns(found)
    highest = 1.05 * max(float(turned[:, inner].max()), 1.0)
    for k, axes in enumerate(np.ravel(grid)):
        if k >= len(inner):
            axes.set_axis_off()
            continue
        j = inner[k]
        axes.plot(found.frames, turned[:, j], color=COLOURS[0], lw=1)
        doubted = np.where(found.confidence[:, j] < 0.5, turned[:, j], np.nan)
        axes.plot(found.frames, doubted, color=COLOURS[1], lw=2.2)
        axes.set_title(found.names[j], fontsize=8)
        axes.set(ylim=(0, highest))
        axes.tick_params(labelsize=7, labelbottom=k + COLUMNS >= len(inner), labelleft=k % COLUMNS == 0)
    figure.supylabel("turned by, °", fontsize=8)
    figure.supxlabel("frame", fontsize=8)
    return figure


def turns(found: Skeleton) -> Floats:
    """(frame, joint) degrees by which each joint has turned against its parent since the reference pose; 0 for the root."""
    parent = np.array(found.parents)
    above = np.where(parent < 0, np.arange(len(parent)), parent)
    trace = np.einsum("tjxy,tjxy->tj", found.rotation[:, above], found.rotation)
    return np.asarray(np.degrees(np.arccos(np.clip((trace - 1) / 2, -1, 1))), dtype=np.float64)


def length_variation(found: Skeleton, aligned: Mapping[int, Alignment]) -> Floats:
    """Standard deviation of every bone's length over the frames, share of its mean, before lengths are fixed.

    Every rigid part is laid onto the aligned mesh of each frame by itself; a joint is amid where the two parts that meet
    in it carry it, the end of a bone where its one part does.
    returns : (joint,) of the bone to the parent; NaN for the root and where a part has too few vertices
    """
    parent = np.array(found.parents)
    X = np.stack([aligned[frame].vertices for frame in found.frames])
    carrier = np.where([kind == "leaf" for kind in found.kinds], parent, np.arange(len(parent)))
    part = {int(j): _laid(found.vertices, X, np.flatnonzero(found.label == j)) for j in np.unique(carrier)}

    def carried(by: int, j: int) -> Floats:
        turn, shift = part[by]
        return np.asarray(turn @ found.rest[j] + shift, dtype=np.float64)

    at = np.stack([carried(int(carrier[j]), j) for j in range(len(parent))], axis=1)
    for j, p in enumerate(parent):
        if p >= 0 and found.kinds[j] == "joint":
            at[:, j] = (at[:, j] + carried(int(p), j)) / 2
    length = np.linalg.norm(at - at[:, np.maximum(parent, 0)], axis=2)
    varies: Floats = length.std(axis=0) / np.maximum(length.mean(axis=0), 1e-300)
    varies[parent < 0] = np.nan
    return varies


def _laid(V: Floats, X: Floats, held: NDArray[np.int64]) -> tuple[Floats, Floats]:
    """(frame, row, xyz) and (frame, xyz): the rigid motion that lays some vertices best onto each frame (Kabsch 1976)."""
    if len(held) < FEWEST:
        return np.full((len(X), 3, 3), np.nan), np.full((len(X), 3), np.nan)
    v, x = V[held].mean(axis=0), X[:, held].mean(axis=1)
    U, _, W = np.linalg.svd(np.einsum("vx,tvy->txy", V[held] - v, X[:, held] - x[:, None]))
    U[:, :, 2] *= np.linalg.det(U @ W)[:, None]
    R = np.swapaxes(U @ W, 1, 2)
    return R, x - R @ v
