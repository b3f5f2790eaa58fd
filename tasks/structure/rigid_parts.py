"""The rigid parts of the body."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.rigid_parts import CutParams, RigidParts, RigidPartsParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.structure import rigid_parts as numerics
from kinetree.tasks.numerics.structure.elimination import EliminationSettings
from kinetree.tasks.numerics.structure.given_correspondence import limited_confidence
from kinetree.tasks.numerics.structure.oversegmentation import OversegmentationSettings
from kinetree.tasks.structure.arguments.aligned_body import tips_of


@task(among=Sequence, block=RigidPartsParams)
def rigid_parts(reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves, params: CutParams) -> RigidParts:
    """Divides the surface into the rigid parts that the motion shows (2014, Sec. 6.1 and 6.2)."""
    aligned = list(alignment.values())
    frames, x = tuple(alignment), np.stack([a.vertices for a in aligned])
    confidence = limited_confidence(np.stack([a.confidence for a in aligned]))
    parts = numerics.rigid_parts(
        reference.vertices,
        np.asarray(reference.faces, dtype=np.int64),
        x,
        confidence,
        tips_of(reference, leaves),
        settings=parts_settings(params),
        takes=take_spans(frames),
    )
    return RigidParts(
        frames=frames,
        label=parts.label,
        rigid=parts.rigid,
        rotation=parts.R,
        translation=parts.t,
        residual=parts.residual,
        **parts.cut._asdict(),
    )


def parts_settings(params: CutParams) -> numerics.RigidPartsSettings:
    """What the numerics take."""
    first_cut = OversegmentationSettings(params.rings, params.patches)
    return numerics.RigidPartsSettings(first_cut, EliminationSettings(params.removal_cost))
