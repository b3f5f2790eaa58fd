"""How branches of the body touch, frame by frame."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.paper_2009.coherent_intervals import CoherentIntervals
from kinetree.schemas.paper_2009.contact_kinds import ContactKinds
from kinetree.schemas.paper_2009.graph_motion import GraphMotion
from kinetree.schemas.paper_2009.integrated_structure import IntegratedStructure
from kinetree.tasks.numerics.paper_2009 import contact_kinds as numerics


@task()
def contact_kinds(
    integrated_structure: IntegratedStructure, motions: Mapping[int, GraphMotion], intervals: CoherentIntervals
) -> ContactKinds:
    """Tells in every incoherent frame which branches touch, and how (2009, Sec. 2.6)."""
    model = integrated_structure
    node, parents, branch, end, label = (np.array(getattr(model, n)) for n in ("node", "parents", "branch", "end", "label"))
    share = numerics.branch_shares(node, parents, branch, end)
    rows = [np.zeros((0, 4), np.int64)]
    for frame, coherent in zip(intervals.frames, intervals.coherent.tolist(), strict=True):
        if not coherent:
            x = np.array(motions[frame].vertices)
            contacts = numerics.contacts(np.array(model.vertices), x, label, branch, share, model.size)
            rows.append(np.concatenate([np.full((len(contacts), 1), frame), contacts], axis=1))
    frames, one, other, kind = np.concatenate(rows).T
    return ContactKinds(frame=frames, branch=one, other=other, kind=kind)
