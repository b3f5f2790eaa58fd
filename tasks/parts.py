"""The rigid parts of the body."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.alignment import Alignment
from kinetree.schemas.leaves import Leaves
from kinetree.schemas.parts import Parts, PartsParams
from kinetree.schemas.reference import Reference
from kinetree.tasks.articulation import tips_of, trust_of
from kinetree.tasks.numerics.structure import parts as structure
from kinetree.tasks.numerics.structure.elimination import Bar


@task()
def parts(reference: Reference, alignment: Mapping[int, Alignment], leaves: Leaves, params: PartsParams) -> Parts:
    """Divides the surface into the rigid parts that the motion shows, as many as would be missed (2014, Sec. 6.1 and 6.2)."""
    aligned = list(alignment.values())
    found = structure.parts(
        reference.vertices,
        np.asarray(reference.faces, dtype=np.int64),
        np.stack([a.vertices for a in aligned]),
        trust_of(aligned),
        tips_of(leaves, reference),
        structure.PartsSettings(rings=params.rings, patches=params.patches, bar=Bar(missed=params.missed)),
    )
    return Parts(
        frames=tuple(alignment),
        label=found.label,
        rigid=found.rigid,
        rotation=found.R,
        translation=found.t,
        residual=found.residual,
    )
