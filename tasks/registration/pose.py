"""Stored poses, deformation graphs and meshes as the numerics take them.

Arrays of their own, writable, so that compiled code meets one kind of array.
"""

import numpy as np

from kinetree.schemas.array import Ints
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.colour_agreement import ColourAgreement
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.pose import Pose
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.refit import Refit
from kinetree.schemas.registration.roll_candidates import RollCandidates
from kinetree.schemas.registration.stiffness import Stiffness
from kinetree.schemas.registration.tracking import Tracking, TrackingParams
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.registration import deformation, roll_candidates
from kinetree.tasks.numerics.registration import deformation_graph as numerics
from kinetree.tasks.numerics.registration.colour_term import FrameColour
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.limb_swing import FrameLimbs
from kinetree.tasks.numerics.registration.near_pose import NearPose

NO_COLOUR, NO_REFERENCE_COLOUR, NO_AGREEMENT = VertexColour.none(), ReferenceColour.none(), ColourAgreement.none()
"""Of a frame, of the reference mesh and of all frames where files have no colours."""


def pose(stored: Pose) -> deformation.Pose:
    """A stored pose."""
    return deformation.Pose(np.array(stored.rotation), np.array(stored.translation))


def first_pose(fitted: FirstFit, recovery: Recovery, frame: int) -> deformation.Pose:
    """The pose of a frame before the first pass: recovered where its first fit was wrong, else as fitted."""
    row = recovery.row(frame)
    if row is None:
        return pose(fitted)
    return deformation.Pose(np.array(recovery.rotation[row]), np.array(recovery.translation[row]))


def rolled_pose(
    graph: numerics.DeformationGraph,
    refit: Refit,
    candidates: RollCandidates,
    stiffness: Stiffness,
    candidate: Ints,
) -> deformation.Pose:
    """The pose of the pass before, with every limb in the candidate (limb,) chosen for it; −1 leaves it as it was."""
    before = pose(refit)
    if not (candidate >= 0).any():
        return before
    fits = roll_candidates.RollCandidates(candidates.angle, candidates.misfit, candidates.rotation, candidates.place)
    return roll_candidates.rolled(graph, before, stiffness.cluster.astype(np.int64), fits, candidate.astype(np.int64))


def fit_settings(params: TrackingParams) -> deformation.FitSettings:
    """How a frame is fitted in tracking."""
    return deformation.FitSettings(**params.model_dump())


def stored_tracking(
    near: NearPose,
    earlier: deformation.Pose,
    steps: int,
    usual: float,
    params: TrackingParams,
    attempt: int = 0,
    frames: tuple[int, int] = (0, 0),
) -> Tracking:
    """A frame of the chain, with the pose before it, its place in the chain and how it is to be fitted.

    frames : source numbers of this frame and of the one before
    """
    return Tracking(
        frame=frames[0],
        earlier_frame=frames[1],
        steps=steps,
        rotation=near.pose.rotation,
        translation=near.pose.translation,
        unexplained=near.distant,
        usual=usual,
        attempt=attempt,
        fitting=params,
        earlier_rotation=earlier.rotation,
        earlier_translation=earlier.translation,
    )


def limbs_of(stored: DeformationGraph, tips: Extrema) -> FrameLimbs:
    """The limbs of the body at rest and of a frame."""
    return FrameLimbs(np.array(stored.stems), np.array(tips.stems), np.array(tips.centre))


def target(
    mesh: Mesh,
    stored: DeformationGraph,
    colour: VertexColour = NO_COLOUR,
    body: ReferenceColour | ColourAgreement = NO_REFERENCE_COLOUR,
) -> Target:
    """A frame prepared to be fitted, with colours where both the frame and the body have them."""
    if not len(colour.colour) or not len(body.colour):
        return Target.of(np.array(mesh.vertices), mesh.faces, stored.size)
    shown = FrameColour(colour.colour / 255.0, body.colour / 255.0)
    return Target.of(np.array(mesh.vertices), mesh.faces, stored.size, colour=shown)


def graph(stored: DeformationGraph) -> numerics.DeformationGraph:
    """The deformation graph."""
    return numerics.DeformationGraph(
        V=np.array(stored.vertices),
        F=stored.faces.astype(np.int64),
        N=np.array(stored.normals),
        node=stored.nodes.astype(np.int64),
        bound=stored.bound.astype(np.int64),
        weight=np.array(stored.weight),
        edge=stored.edges.astype(np.int64),
        sample=stored.samples.astype(np.int64),
        size=stored.size,
        start=np.concatenate([[0], np.cumsum(stored.degree, dtype=np.int64)]),
        ring=stored.ring.astype(np.int64),
        pair=stored.blocks.astype(np.int64),
        of_vertex=stored.block_of_vertex.astype(np.int64),
        of_edge=stored.block_of_edge.astype(np.int64),
    )
