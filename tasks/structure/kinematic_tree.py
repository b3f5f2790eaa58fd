"""The articulated body: one tree of joints over the rigid parts, a pose for every frame, and the skin that follows."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.further_cut import FurtherCut
from kinetree.schemas.structure.kinematic_tree import JointParams, KinematicTree, KinematicTreeParams, PruningParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.geometry.surface import surface_areas
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure import kinematic_tree as numerics
from kinetree.tasks.numerics.structure.end_effectors import leaf_vertices
from kinetree.tasks.numerics.structure.given_correspondence import is_given, limited_confidence
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, JointEvidenceSettings
from kinetree.tasks.numerics.structure.pose_refinement import needs_refinement
from kinetree.tasks.numerics.structure.pruning import PruningSettings
from kinetree.tasks.numerics.structure.tree_joints import Cut, KinematicTreeSettings


@task(among=Sequence)
def kinematic_tree(
    reference: Reference,
    rigid_parts: RigidParts,
    further_cut: Mapping[int, FurtherCut],
    alignment: Mapping[int, Alignment],
    mesh: Mapping[int, Mesh],
    leaves: Leaves,
    params: KinematicTreeParams,
) -> KinematicTree:
    """Joins the rigid parts into one tree, places its joints and poses it in every frame (2014, Sec. 6.3)."""
    frames, aligned, at = tuple(alignment), list(alignment.values()), leaves.frames.index(reference.frame)
    evidence = FrameEvidence.of(
        np.stack([a.confidence for a in aligned]),
        np.stack([a.residual for a in aligned]),
        lambda t: (np.array(mesh[frames[t]].vertices, np.float64), np.array(mesh[frames[t]].faces, np.int64)),
        evidence_settings(params),
    )
    given = is_given(evidence.confidence, evidence.residual)
    V, F = reference.vertices, reference.faces
    tree, derivation = numerics.kinematic_tree(
        V,
        np.asarray(F, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        surface_areas(V, F),
        np.asarray(rigid_parts.label, dtype=np.int64),
        rigid_parts.rotation,
        rigid_parts.translation,
        rigid_parts.residual,
        leaf_vertices(V, leaves.positions[:, at], leaves.rows[:, at], leaves.kept),
        limited_confidence(evidence.confidence),
        None if given else evidence,
        settings=tree_settings(params)._replace(
            hidden_bones=params.hidden_bones and given, end_joints=params.end_joints, surface_joints=params.surface_joints
        ),
        takes=take_spans(frames),
        further=[_cut(cut, alignment[frame]) for frame, cut in further_cut.items() if not cut.joined],
        carried=[np.array(cut.joints) for cut in further_cut.values() if cut.joined],
    )
    return KinematicTree(
        frames=frames,
        vertices=V,
        faces=F,
        cuts=1 + len(further_cut),
        uncertain=np.zeros(len(frames), np.bool_) if given else needs_refinement(tree.confidence),
        **{**tree._asdict(), "parents": tuple(tree.parents.tolist())},
        **{**derivation._asdict(), "dropped": tuple((d.part, d.reason) for d in derivation.dropped)},
    )


def _cut(further: FurtherCut, pose: Alignment) -> Cut:
    """What the numerics take."""
    V, label = np.array(pose.vertices, np.float64), np.asarray(further.label, dtype=np.int64)
    return Cut(V, label, np.array(further.rotation), np.array(further.translation), np.array(further.residual))


def evidence_settings(params: JointParams) -> JointEvidenceSettings:
    """What makes a joint evident in the frames."""
    return JointEvidenceSettings(params.clear_motion, params.misfit_ratio, params.misfit_ratio_if_moving)


def tree_settings(params: PruningParams) -> KinematicTreeSettings:
    """How parts become joints."""
    return KinematicTreeSettings(PruningSettings(params.degrees, params.ratio))
