"""Shapes whose answers are known: each returns V (vertex, xyz) and F (face, corner), outside counter-clockwise."""

import numpy as np
import numpy.typing as npt
import trimesh

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]
Mesh = tuple[Floats, Ints]


def sphere(subdivisions: int = 4) -> Mesh:
    """Unit sphere of nearly equal triangles: g(u, v) = arccos(u·v), up to the chords' shortening."""
    ball = trimesh.creation.icosphere(subdivisions)
    return np.array(ball.vertices, np.float64), np.array(ball.faces, np.int64)


def flat_grid(columns: int, rows: int, shear: float = 0.0) -> Mesh:
    """Unit squares in the plane z = 0, each cut once: g(u, v) = |u − v|; any shear keeps the shape convex.

    Vertex (i, j) is number i·rows + j at x = i + shear·j, y = j; a shear above 1 makes every triangle obtuse.
    """
    i, j = np.meshgrid(np.arange(columns), np.arange(rows), indexing="ij")
    V = np.stack([i + shear * j, j, np.zeros_like(i)], axis=-1).reshape(-1, 3).astype(np.float64)
    a = (i[:-1, :-1] * rows + j[:-1, :-1]).ravel()
    b, c, d = a + rows, a + rows + 1, a + 1
    return V, np.concatenate([np.stack([a, b, c], axis=1), np.stack([a, c, d], axis=1)])


def folded(V: Floats, crease: float, angle: float) -> Floats:
    """The part of a flat shape beyond x = crease turned about that line; lengths over the surface stay as they were."""
    beyond = np.maximum(V[:, 0] - crease, 0.0)
    return V + beyond[:, None] * np.array([np.cos(angle) - 1.0, 0.0, np.sin(angle)])


def open_cylinder(around: int, along: int, radius: float = 1.0, height: float = 4.0) -> Mesh:
    """A tube with two open ends whose `around` flat sides unroll into the plane; see `over_cylinder`."""
    theta = 2 * np.pi * np.arange(around) / around
    z = np.linspace(0.0, height, along)
    ring = np.stack([radius * np.cos(theta), radius * np.sin(theta)], axis=1)
    V = np.concatenate([np.repeat(ring, along, axis=0), np.tile(z, around)[:, None]], axis=1)
    i, j = np.meshgrid(np.arange(around), np.arange(along - 1), indexing="ij")
    a, b = (i * along + j).ravel(), ((i + 1) % around * along + j).ravel()
    return V, np.concatenate([np.stack([a, b, b + 1], axis=1), np.stack([a, b + 1, a + 1], axis=1)])


def over_cylinder(V: Floats, source: int, around: int) -> Floats:
    """(vertex,) exact distances over `open_cylinder`: straight lines on its unrolled sides, the shorter way round."""
    side = 2 * np.linalg.norm(V[source, :2]) * np.sin(np.pi / around)
    step = np.arctan2(V[:, 1], V[:, 0]) - np.arctan2(V[source, 1], V[source, 0])
    sides = np.rint(step * around / (2 * np.pi)) % around
    return np.hypot(np.minimum(sides, around - sides) * side, V[:, 2] - V[source, 2])


def three_pages(columns: int, rows: int) -> tuple[Floats, Ints, Ints]:
    """Three flat pages bound at the edges x = y = 0: every edge of the spine lies in three faces.

    Beside V and F: (vertex,) the page of each vertex, −1 on the spine. Two pages together are flat once opened, so
    g(u, v) = √((r_u + r_v)² + (z_u − z_v)²) across pages and |u − v| on one, r the distance from the spine.
    """
    flat, faces = flat_grid(columns, rows)
    pages = [np.arange(rows)]
    V, F = [np.stack([flat[:rows, 0], flat[:rows, 0], flat[:rows, 1]], axis=1)], []
    for k in range(3):
        number = np.concatenate([np.arange(rows), np.arange(rows, len(flat)) + k * (len(flat) - rows)])
        F.append(number[faces])
        r, z = flat[rows:, 0], flat[rows:, 1]
        V.append(np.stack([r * np.cos(2 * np.pi * k / 3), r * np.sin(2 * np.pi * k / 3), z], axis=1))
        pages.append(np.full(len(flat) - rows, k))
    pages[0][:] = -1
    return np.concatenate(V), np.concatenate(F), np.concatenate(pages)


def y_pipe(arm: int = 24, half_width: int = 4) -> tuple[Floats, Ints, Ints]:
    """A closed pipe of three equal arms in the plane z = 0, symmetric under a third of a turn.

    Beside V and F: (vertex,) the vertex onto which a third of a turn carries each; three turns are none. The three
    farthest points are the arms' tips, and the middle is nearest to all.
    """
    reach = arm + 2 * half_width
    a, b = (c.ravel() for c in np.meshgrid(*[np.arange(-reach, reach + 1)] * 2, indexing="ij"))
    xy = np.stack([a + 0.5 * b, np.sqrt(0.75) * b], axis=1)
    turned = np.stack([-a - b, a], axis=1)  # a third of a turn in lattice coordinates
    from_bone = np.full(len(a), np.inf)
    for k in range(3):
        tip = arm * np.array([np.cos(2 * np.pi * k / 3), np.sin(2 * np.pi * k / 3)])
        along = np.clip(xy @ tip / (tip @ tip), 0.0, 1.0)
        from_bone = np.minimum(from_bone, np.linalg.norm(xy - along[:, None] * tip, axis=1))
    number = {(int(p), int(q)): k for k, (p, q) in enumerate(zip(a, b, strict=True))}
    inside = {k for k in range(len(a)) if from_bone[k] < half_width + 1e-9}
    cells = [
        tuple(number.get(corner, -1) for corner in corners)
        for p, q in number
        for corners in (((p, q), (p + 1, q), (p, q + 1)), ((p + 1, q), (p + 1, q + 1), (p, q + 1)))
    ]
    F = np.array([cell for cell in cells if inside.issuperset(cell)])
    used, F = np.unique(F, return_inverse=True)
    F = F.reshape(-1, 3)
    edges = np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    edge, count = np.unique(edges, axis=0, return_counts=True)
    rim = np.zeros(len(used), bool)
    rim[edge[count == 1]] = True
    z = np.where(rim, 0.0, np.sqrt(np.maximum(half_width**2 - from_bone[used] ** 2, 0.25)))
    below = np.where(rim, np.arange(len(used)), len(used) - 1 + np.cumsum(~rim))
    V = np.concatenate([np.column_stack([xy[used], z]), np.column_stack([xy[used], -z])[~rim]])
    place = {number[int(p), int(q)]: k for k, (p, q) in enumerate(np.column_stack([a, b])[used])}
    onto = np.array([place[number[int(p), int(q)]] for p, q in turned[used]])
    return V, np.concatenate([F, below[F][:, ::-1]]), np.concatenate([onto, below[onto][~rim]])


def two_components(subdivisions: int = 2) -> Mesh:
    """Two unit spheres, ten apart: the first half of the vertices cannot reach the second."""
    V, F = sphere(subdivisions)
    return np.concatenate([V, V + np.array([10.0, 0.0, 0.0])]), np.concatenate([F, F + len(V)])
