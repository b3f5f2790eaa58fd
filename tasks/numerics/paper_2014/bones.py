"""Joints in the non-rigid areas, and the bones between them (2014, Sec. 6.3.1 and 6.3.2; Fig. 15)."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from kinetree.tasks.numerics.arrays import Flags, Floats, Ints
from kinetree.tasks.numerics.paper_2014.cones import edges
from kinetree.tasks.numerics.paper_2014.cylinders import Areas
from kinetree.tasks.numerics.structure.spanning_tree import spanning


class Bones(NamedTuple):
    """Bones between joints.

    part      : (area,) rigid part of each area, −1 for joints
    bone      : (bone, 2) areas of its two joints
    bone_part : (bone,) the rigid part between them, −1 where they are adjacent to each other only
    variation : (bone,) standard deviation of its length over the frames, mesh unit
    in_tree   : (bone,) whether it is in the minimum spanning tree on the variation; the others are redundant
    """

    part: Ints
    bone: Ints
    bone_part: Ints
    variation: Floats
    in_tree: Flags


def bones(label: Ints, rigid: Flags, F: Ints, centroid: Floats) -> Bones:
    """Bones between joints that are adjacent to each other or to one rigid part, and which are redundant (Sec. 6.3.1, 6.3.2).

    label    : (vertex,) area
    rigid    : (area,) whether it is rigid
    F        : (face, corner)
    centroid : (frame, area, xyz) mesh unit; NaN where an area is not seen
    """
    adjacency = adjacent(label, F, len(rigid))
    part = rigid_parts(adjacency, rigid)
    bone, bone_part = candidates(adjacency, part)
    variation = length_variation(centroid, bone)
    in_tree = np.isin(np.arange(len(bone)), spanning(bone, variation, centroid.shape[1]))
    return Bones(part, bone, bone_part, variation, in_tree)


def adjacent(label: Ints, F: Ints, count: int) -> Flags:
    """(area, area) which areas share an edge of the mesh.

    label, F : (vertex,) area · (face, corner)
    count    : number of areas
    """
    a, b = label[edges(F)].T
    out = np.zeros((count, count), dtype=bool)
    out[a, b] = out[b, a] = True
    np.fill_diagonal(out, val=False)
    return out


def rigid_parts(adjacency: Flags, rigid: Flags) -> Ints:
    """(area,) rigid areas with no joint between them are one rigid part; −1 for areas that are not rigid.

    adjacency : (area, area) see `adjacent`
    rigid     : (area,)
    """
    links = coo_array(adjacency & rigid[:, None] & rigid[None, :])
    component = connected_components(links, directed=False)[1]
    return np.where(rigid, np.unique(np.where(rigid, component, -1), return_inverse=True)[1] - int(not rigid.all()), -1)


def joint_adjacency(adjacency: Flags, part: Ints) -> Flags:
    """(part, area) whether a rigid part is adjacent to an area.

    adjacency : (area, area) see `adjacent`
    part      : (area,) see `rigid_parts`
    """
    count = int(part.max(initial=-1)) + 1
    return np.array([adjacency[:, part == p].any(axis=1) for p in range(count)], bool).reshape(count, len(part))


def candidates(adjacency: Flags, part: Ints) -> tuple[Ints, Ints]:
    """Bones between joints whose areas are adjacent to one another or to the same rigid part (Sec. 6.3.1 and 6.3.2).

    adjacency, part : see `adjacent`, `rigid_parts`
    returns         : (bone, 2) areas that are joints · (bone,) the part between, −1 where they are adjacent to one another only
    """
    joint = np.flatnonzero(part < 0)
    of_part = joint_adjacency(adjacency, part)
    pair, between = [], []
    for position, i in enumerate(joint):
        for j in joint[position + 1 :]:
            common = np.flatnonzero(of_part[:, i] & of_part[:, j])
            if len(common) or adjacency[i, j]:
                pair.append((i, j))
                between.append(int(common[0]) if len(common) else -1)
    return np.array(pair, np.int64).reshape(-1, 2), np.array(between, np.int64)


def length_variation(centroid: Floats, bone: Ints) -> Floats:
    """(bone,) standard deviation of each bone's length over the frames, mesh unit; infinite if no frame sees it (Sec. 6.3.2).

    centroid : (frame, area, xyz) of the joints; NaN in frames in which they are not seen
    bone     : (bone, 2) areas of its joints
    """
    length = np.linalg.norm(centroid[:, bone[:, 0]] - centroid[:, bone[:, 1]], axis=2)
    return np.array([np.std(row[np.isfinite(row)]) if np.isfinite(row).any() else np.inf for row in length.T])


def interval_labels(model: Areas, cones: int, annulus: Ints, model_vertex: Ints) -> Ints:
    """The areas on one interval's reference: those of cones by annulus index (Sec. 6.1.3), the others over the cuts (ours).

    model        : the areas on the model mesh
    cones        : number of cones, which are the first of the cones and cylinders
    annulus      : (cone, vertex) annuli of the interval's own cones
    model_vertex : (vertex,) the model's vertex at each of the interval's, −1 for none
    returns      : (vertex,) area, −1 where neither tells it
    """
    mapped = np.where(model_vertex >= 0, model.label[model_vertex], -1)
    own = np.full(annulus.shape, -1)
    for area in np.flatnonzero(model.cylinder < cones):
        cone = int(model.cylinder[area])
        inside = (annulus[cone] >= model.first_annulus[area]) & (annulus[cone] <= model.last_annulus[area])
        own[cone, inside] = area
    claims = (own >= 0).sum(axis=0)
    of_cone = (mapped >= 0) & (model.cylinder[mapped] < cones)
    return np.where(claims == 1, own.max(axis=0, initial=-1), np.where((claims == 0) & of_cone, -1, mapped))


def area_centroids(x: Floats, label: Ints, area: Floats, count: int) -> Floats:
    """(frame, area, xyz) centroid of the surface of each area, mesh unit; NaN where an area has none (Sec. 6.3.1).

    x     : (frame, vertex, xyz) mesh unit
    label : (vertex,) area, −1 for none
    area  : (vertex,) mesh unit²
    count : number of areas
    """
    out = np.full((len(x), count, 3), np.nan)
    for a in range(count):
        inside = (label == a) & (area > 0.0)
        if inside.any():
            out[:, a] = np.einsum("v,tvx->tx", area[inside] / area[inside].sum(), x[:, inside])
    return out
