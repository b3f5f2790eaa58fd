"""The frames' surfaces as evidence for joints, as the numerics of this shelf take it."""

from collections.abc import Mapping

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.kinematic_tree import JointParams
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, JointEvidenceSettings
from kinetree.tasks.structure.arguments.aligned_body import AlignedBody


def frame_evidence(
    body: AlignedBody, alignment: Mapping[int, Alignment], mesh: Mapping[int, Mesh], params: JointParams
) -> FrameEvidence | None:
    """What the frames show; None where they give the correspondence, so that they show nothing more."""
    if body.is_given:
        return None
    frames = tuple(alignment)
    return FrameEvidence.of(
        body.trust,
        np.stack([a.residual for a in alignment.values()]),
        lambda t: (np.array(mesh[frames[t]].vertices, np.float64), np.array(mesh[frames[t]].faces, np.int64)),
        evidence_settings(params),
    )


def evidence_settings(params: JointParams) -> JointEvidenceSettings:
    """What makes a joint evident in the frames."""
    return JointEvidenceSettings(params.clear_motion, params.misfit_ratio, params.misfit_ratio_if_moving)
