"""Cleaning of one mesh: welded, without waste, oriented outwards, only the body left, and the way back to the input.

The papers assume a clean closed surface (2014, Sec. 3); captured and exported meshes have seams, debris, shells inside
and faces turned inside out. Thresholds are relative to the mesh's own size, so that none knows a unit.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from kinetree.errors import MeshError
from kinetree.tasks.numerics.arrays import Faces, Flags, Floats, Ints, Labels
from kinetree.tasks.numerics.compiled import compiled
from kinetree.tasks.numerics.geometry.normals import area_vectors
from kinetree.tasks.numerics.geometry.orientation import half_edges, lexicographic, oriented, winding
from kinetree.tasks.numerics.input.welding import welded
from kinetree.tasks.numerics.input.whole_faces import whole_faces

_SMALLEST_DIAGONAL = 1e-100
"""Mesh unit; of a smaller diagonal the cube, or that of its inverse, is no number."""
_FARTHEST = 1e150
"""Box diagonals; what lies farther is in no face, and its square must be a number."""


class MeshSettings(NamedTuple):
    """What counts as rounding, and as lying inside another component."""

    needle: float = 1e-6
    """Height over longest edge below which a face's normal is rounding error; such faces are counted and stay."""
    inside: float = 0.9
    """Winding number from which a point is inside: 1 in a closed surface, hardly less behind small holes, about 0.5 in a bowl.
    Not varied so far."""
    probes: int = 32
    """Vertices of a component that must all be inside; the bounding box is tried first and excludes most. Not varied so far."""


@dataclass(frozen=True)
class Cleaned:
    """A clean mesh, what was done to get it, and where every input vertex went.

    Input vertices = merged + unreferenced + left_out_vertices + len(V);
    input faces = degenerate + duplicate + folded + left_out_faces + len(F).

    V, F          : (vertex, xyz) mesh unit · (face, corner); survivors in the input's order
    vertex_map    : (input_vertex,) its vertex in V, −1 if dropped: labels come back as `labels[vertex_map]`
    face_origin   : (face,) which input face it was
    merged        : vertices welded to an earlier one
    unreferenced  : vertices, after welding, in no face
    degenerate    : faces dropped because two corners are one vertex after welding
    duplicate     : faces dropped because an earlier one has the same three corners
    folded        : faces dropped in pairs that face away from each other on the same three corners
    needles       : faces without height, kept because taking one out would open the surface
    flipped       : faces of F turned the other way round
    shares        : (component,) share of the surface's area, in the order of the components' first faces
    is_body       : (component,) True where it is in F
    nested        : components dropped only because they lie wholly inside another
    left_out_vertices, left_out_faces  : those of the dropped components
    boundary_edges, non_manifold_edges : edges of F with one face, with more than two
    disagreeing_edges : edges of F whose two faces cannot be made to agree (a Möbius strip has some)
    euler         : vertices − edges + faces; 2 for a sphere, 0 for a torus, 1 for a disc
    area, volume  : mesh unit², mesh unit³; volume is NaN unless every edge has two faces that agree
    """

    V: Floats
    F: Faces
    vertex_map: Labels
    face_origin: Labels
    merged: int
    unreferenced: int
    degenerate: int
    duplicate: int
    folded: int
    needles: int
    flipped: int
    shares: Floats
    is_body: Flags
    nested: int
    left_out_vertices: int
    left_out_faces: int
    boundary_edges: int
    non_manifold_edges: int
    disagreeing_edges: int
    euler: int
    area: float
    volume: float


def clean(
    V: Floats,
    F: Faces,
    *,
    merge: float = 1e-7,
    component_share: float = 0.05,
    name: str = "mesh",
    settings: MeshSettings | None = None,
) -> Cleaned:
    """Weld, drop what is no surface, orient outwards and keep the body; cleaning twice changes nothing more.

    Components are what shared edges connect. Kept are the largest, and those of at least `component_share` of the area
    that do not lie wholly inside a larger one. An arm has about 0.08 of a body's area and must stay; what floats by
    itself with less than 0.05 is debris, or a hand that no distance over the surface can tie to the body.
    Faces back to back are a fin folded flat and go in pairs, which leaves every edge as even as it was; where they make
    up `component_share` of the area they are a sheet drawn from both sides, and the first side stays.
    Faces without height stay.

    V               : (vertex, xyz) finite, mesh unit
    F               : (face, corner) indices into V
    merge           : vertices closer than this share of the bounding box's diagonal are one; at 0 only equal ones
    component_share : of the whole area, 0 to 1
    name            : what messages call the mesh
    raises          : MeshError if no face or no area is left
    """
    chosen = settings or MeshSettings()
    X, diagonal = _relative(V, F, name)
    first = welded(X, merge)
    faces = whole_faces(X, first[F], component_share)
    G, area = first[F[faces.origin]], faces.area
    if not area.sum() > 0:
        raise MeshError(
            f"{name}: its {len(F)} faces have no area, the corners of each lie in one point or on one line; export the frame"
            " again with more digits, or leave it out"
        )
    turned, component = oriented(X, G)
    G = np.where(turned[:, None], G[:, [0, 2, 1]], G)
    shares = np.bincount(component, weights=area) / area.sum()
    inside, keep_component = _body(X, G, component, shares, component_share, chosen)
    keep = keep_component[component]
    V_new, F_new, vertex_map = _compacted(V, G[keep], first)
    edges = _edge_counts(F_new, len(V_new))
    referenced = int((np.bincount(G.ravel()) > 0).sum())
    stays = first == np.arange(len(V))
    return Cleaned(
        V=V_new,
        F=F_new,
        vertex_map=vertex_map,
        face_origin=faces.origin[keep].astype(np.int32),
        merged=int((~stays).sum()),
        unreferenced=int(stays.sum()) - referenced,
        degenerate=faces.degenerate,
        duplicate=faces.duplicate,
        folded=faces.folded,
        needles=int(_needles(X, G[keep], area[keep], chosen.needle)),
        flipped=int(turned[keep].sum()),
        shares=shares,
        is_body=keep_component,
        nested=int(inside.sum()),
        left_out_vertices=referenced - len(V_new),
        left_out_faces=len(G) - len(F_new),
        boundary_edges=edges[0],
        non_manifold_edges=edges[1],
        disagreeing_edges=edges[2],
        euler=len(V_new) - edges[3] + len(F_new),
        area=float(area[keep].sum() * diagonal**2),
        volume=float("nan") if any(edges[:3]) else _volume(X, G[keep]) * diagonal**3,
    )


def _relative(V: Floats, F: Faces, name: str) -> tuple[Floats, float]:
    """(vertex, xyz) in diagonals of the faces' bounding box from its lowest corner · the diagonal, mesh unit.

    The box is that of the faces alone: one stray vertex far away must not widen what counts as close.

    raises : MeshError if there is no face or the diagonal is no length
    """
    if not len(F):
        raise MeshError(
            f"{name}: no faces, only {len(V)} vertices; a surface is needed, not a point cloud: mesh the points first"
        )
    corners = V[F.ravel()]
    diagonal = float(np.hypot.reduce(corners.max(axis=0) / 2 - corners.min(axis=0) / 2)) * 2
    if not _SMALLEST_DIAGONAL < diagonal < 1 / _SMALLEST_DIAGONAL:
        raise MeshError(
            f"{name}: its bounding box has a diagonal of {diagonal:.3g}; the coordinates are damaged:"
            " export the frame again, or leave it out"
        )
    with np.errstate(over="ignore"):
        return np.clip((V - corners.min(axis=0)) / diagonal, -_FARTHEST, _FARTHEST), diagonal


def _body(X: Floats, F: Faces, component: Ints, shares: Floats, least: float, settings: MeshSettings) -> tuple[Flags, Flags]:
    """(component,) large enough but wholly inside a larger one · (component,) to be kept."""
    large = shares >= min(least, float(shares.max()))
    inside = np.zeros(len(shares), dtype=bool)
    ranked = np.flatnonzero(large)[np.argsort(-shares[large], kind="stable")]
    parts = {c: F[component == c] for c in ranked} if len(ranked) > 1 else {}
    for i, c in enumerate(ranked):
        own = np.unique(parts[c]) if parts else np.empty(0, dtype=np.int32)
        probes = X[own[np.linspace(0, len(own) - 1, min(settings.probes, len(own))).astype(int)]]
        for other in ranked[:i]:
            box = X[parts[other].ravel()]
            within = (X[own] > box.min(axis=0)).all() and (X[own] < box.max(axis=0)).all()
            inside[c] |= within and bool((winding(probes, X, parts[other]) > settings.inside).all())
    return inside, large & ~inside


def _compacted(V: Floats, F: Faces, first: Faces) -> tuple[Floats, Faces, Faces]:
    """Only the vertices in use, the faces that use them, and where every input vertex went (−1: nowhere)."""
    used = np.zeros(len(V), dtype=bool)
    used[F] = True
    position = np.where(used, np.cumsum(used) - 1, -1).astype(np.int32)
    return np.ascontiguousarray(V[used]), position[F], position[first]


def _edge_counts(F: Faces, n: int) -> tuple[int, int, int, int]:
    """How many edges have one face, more than two, two that disagree, and how many edges there are."""
    ends = half_edges(F)
    order = lexicographic(ends, n)
    key = (ends[:, 0].astype(np.int64) * n + ends[:, 1])[order]
    start = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    degree = np.diff(start, append=len(key))
    upward = (F[:, [1, 2, 0]] > F).ravel()[order].view(np.int8)
    disagreeing = (degree == 2) & (np.add.reduceat(upward, start) != 1)
    return int((degree == 1).sum()), int((degree > 2).sum()), int(disagreeing.sum()), len(start)


def _volume(X: Floats, F: Faces) -> float:
    """Volume inside a closed surface that faces outwards, by the divergence theorem."""
    return float(np.einsum("fx,fx->", X[F[:, 0]] - X[F[0, 0]], area_vectors(X, F)) / 3)


@compiled
def _needles(X: Floats, F: Faces, area: Floats, height: float) -> int:
    """How many faces are lower than this share of their longest edge."""
    count = 0
    for f in range(len(F)):
        longest = 0.0
        for k in range(3):
            a, b = F[f, k], F[f, (k + 1) % 3]
            squared = (X[b, 0] - X[a, 0]) ** 2 + (X[b, 1] - X[a, 1]) ** 2 + (X[b, 2] - X[a, 2]) ** 2
            longest = max(longest, squared)
        count += 2 * area[f] <= height * longest
    return count
