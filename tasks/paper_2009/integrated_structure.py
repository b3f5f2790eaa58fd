"""One kinematic structure of all intervals."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.initial_frames import InitialFrames
from kinetree.schemas.paper_2009.initial_model import InitialModel
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.schemas.paper_2009.node_clusters import NodeClusters
from kinetree.schemas.paper_2009.similarity import Similarity
from kinetree.tasks.numerics.paper_2009 import integrated_structure as numerics
from kinetree.tasks.numerics.paper_2009.initial_frames import reached_from

OF_TREE = ("node", "parents", "branch", "end", "track")
"""What is compared of each structure's model."""


@task()
def integrated_structure(
    initial_frames: InitialFrames,
    models: Mapping[int, InitialModel],
    clusters: Mapping[int, NodeClusters],
    similarity: Similarity,
) -> IntegratedStructure:
    """Takes each branch from the structure that is most detailed there (2009, Sec. 2.4; Fig. 3)."""
    rows = [
        numerics.Piecewise(**{name: np.array(getattr(m, name)) for name in OF_TREE}, cluster=np.array(c.cluster))
        for m, c in zip(models.values(), clusters.values(), strict=True)
    ]
    one = numerics.integrated_structure(rows)
    base, own = models[one.base], clusters[one.base]
    whole = bool((one.source == one.base).all())
    start = initial_frames.frames.index(base.frame)
    in_base = initial_frames.structure == one.base
    by_correlation = len(rows) > 1
    reached = reached_from(np.array(similarity.similarity), start, by_correlation=by_correlation)
    return IntegratedStructure(
        **{name: getattr(base, name) for name in InitialModel.model_fields},
        frames=initial_frames.frames,
        structure=one.base,
        source=one.source,
        cluster=own.cluster if whole else one.cluster,
        part=own.part if whole else one.cluster[base.label],
        correlation=own.correlation,
        before=np.where(in_base, initial_frames.before, reached),
    )
