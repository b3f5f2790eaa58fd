"""The clusters of the integrated structure as a skeleton like any other."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.paper_2009.graph_motion import GraphMotion
from kinetree.schemas.paper_2009.graph_skeleton import GraphSkeletonParams
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.paper_2009.edge_joints import NodeMotion, edge_joints
from kinetree.tasks.numerics.paper_2009.node_clusters import part_motions, rigid_clusters
from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.numerics.structure.first_tree import first_tree
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence
from kinetree.tasks.numerics.structure.part_tree import MovingSurface
from kinetree.tasks.numerics.structure.pose_refinement import needs_refinement
from kinetree.tasks.numerics.structure.tree_joints import Cut
from kinetree.tasks.structure.arguments.frame_evidence import evidence_settings
from kinetree.tasks.structure.first_tree import tree_settings


@task()
def graph_skeleton(
    integrated_structure: IntegratedStructure,
    motions: Mapping[int, GraphMotion],
    alignment: Mapping[int, Alignment],
    meshes: Mapping[int, Mesh],
    params: GraphSkeletonParams,
) -> KinematicTree:
    """Places joints between clusters and gives the skeleton its skin, its lengths and its poses (2009, Sec. 2.4, 2.5)."""
    s = integrated_structure
    by_centres = params.joints == "centres"
    tree, derivation = _centres(s, alignment, meshes, params) if by_centres else (_edges(s, motions), None)
    count, parts = len(tree.parents), int(s.part.max()) + 1
    unknown = np.full(count, np.nan)
    derived = derivation._asdict() if derivation else numerics.Derivation(
        np.array(s.part, np.int64), np.zeros((0, 2), np.int64), np.zeros((0, 3)), np.zeros(0), np.zeros(0),
        np.full(parts, -1), (), np.zeros(count), np.zeros(count), unknown, np.zeros(count, np.int64),
        np.zeros(count), unknown, unknown, unknown, np.full(count, -1),
    )._asdict()  # fmt: skip
    return KinematicTree(
        frames=tuple(motions),
        vertices=s.vertices,
        faces=s.faces,
        uncertain=needs_refinement(tree.confidence) if by_centres else np.zeros(len(motions), np.bool_),
        **{**tree._asdict(), "parents": tuple(tree.parents.tolist())},
        **{**derived, "dropped": tuple((d.part, d.reason) for d in derived["dropped"])},
    )


def _centres(
    s: IntegratedStructure, alignment: Mapping[int, Alignment], meshes: Mapping[int, Mesh], params: GraphSkeletonParams
) -> tuple[numerics.KinematicTree, numerics.Derivation]:
    """Joints where clusters turn about each other: the nodes' pieces of the aligned surface that move as one (ours)."""
    V, F, aligned, frames = np.array(s.vertices), np.array(s.faces), list(alignment.values()), tuple(alignment)
    x, confidence = np.stack([a.vertices for a in aligned]), np.stack([a.confidence for a in aligned])
    area = surface_areas(V, F)
    evidence = FrameEvidence.of(
        confidence,
        np.stack([a.residual for a in aligned]),
        lambda t: (np.array(meshes[frames[t]].vertices), np.array(meshes[frames[t]].faces, np.int64)),
        evidence_settings(params),
    )
    label = rigid_clusters(V, F, x, confidence, area, np.array(s.label), params.removal_cost)
    part = part_motions(V, x, confidence, area, label, params.removal_cost)
    leaves = np.array(s.leaf_vertex)
    settings = tree_settings(params)._replace(root_amid_limbs=params.root == "limbs")
    body = MovingSurface(V, F.astype(np.int64), x, area)
    first = first_tree(body, Cut(V, *part), leaves, confidence, evidence, settings=settings)
    return numerics.kinematic_tree(body, first, leaves, confidence, has_second_ends=params.second_ends)


def _edges(s: IntegratedStructure, motions: Mapping[int, GraphMotion]) -> numerics.KinematicTree:
    """Joints amid the edges at which clusters meet."""
    node, joint, parents, cluster = (np.array(getattr(s, n)) for n in ("node", "joint", "parents", "cluster"))
    X, R = (np.stack([getattr(m, n) for m in motions.values()]) for n in ("position", "rotation"))
    V, label, bound, weight, end, leaf = (
        np.array(getattr(s, n)) for n in ("vertices", "label", "bound", "weight", "end", "leaf_vertex")
    )
    return edge_joints(NodeMotion(node, joint, parents, cluster, X, R), V, label, bound, weight, end, leaf, s.size)
