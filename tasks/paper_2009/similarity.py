"""How alike the graphs of all frames are."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.reeb_graph import ReebGraph
from kinetree.schemas.paper_2009.similarity import Similarity, SimilarityParams
from kinetree.tasks.numerics.paper_2009 import similarity as numerics
from kinetree.tasks.numerics.paper_2009.reeb_graph import ReebGraph as Graph


@task()
def similarity(reeb_graphs: Mapping[int, ReebGraph], params: SimilarityParams) -> Similarity:
    """Correlates the graphs of every two frames, from coarse to fine (2009, Sec. 2.3; Tung and Schmitt 2005)."""
    frames = [
        numerics.attributes(Graph(**{name: np.array(values) for name, values in graph.arrays().items()}))
        for graph in reeb_graphs.values()
    ]
    return Similarity(frames=tuple(reeb_graphs), similarity=numerics.similarities(frames, params.weight))
