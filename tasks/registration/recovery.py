"""Lost and exchanged limbs put right: frames whose first fit failed, tracked again from frames beyond and alike ones."""

from collections.abc import Mapping
from types import MappingProxyType

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.first_fit import FirstFit
from kinetree.schemas.registration.recovery import Recovery
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.input.frame_numbers import take_spans
from kinetree.tasks.numerics.registration import recovery as numerics
from kinetree.tasks.numerics.registration.take_entries import Limbs
from kinetree.tasks.registration.pose import NO_COLOUR, NO_REFERENCE_COLOUR, fit_settings, graph, limbs_of, pose, target


@task(among=Sequence)
def recovery(
    deformation_graph: DeformationGraph,
    take_entries: TakeEntries,
    first_fit: Mapping[int, FirstFit],
    mesh: Mapping[int, Mesh],
    tips: Mapping[int, Extrema],
    vertex_colour: Mapping[int, VertexColour] = MappingProxyType({}),
    reference_colour: ReferenceColour = NO_REFERENCE_COLOUR,
) -> Recovery:
    """Tracks frames again that leave more uncovered than the others, or bend the body more than alike ones do (ours)."""
    frames = tuple(first_fit)
    uncovered = np.array([f.uncovered for f in first_fit.values()])
    roots = [frames.index(t) for t in (deformation_graph.frame, *take_entries.frames)]
    spans = [(span, next(t for t in roots if span.start <= t < span.stop)) for span in take_spans(frames)]
    outcome = numerics.recovery(
        graph(deformation_graph),
        uncovered,
        lambda at: pose(first_fit[frames[at]]),
        lambda at: target(mesh[frames[at]], deformation_graph, vertex_colour.get(frames[at], NO_COLOUR), reference_colour),
        frames.index(deformation_graph.frame),
        fit_settings(first_fit[deformation_graph.frame].fitting),
        takes=spans,
        limbs=lambda at: limbs_of(deformation_graph, tips[frames[at]]),
        seen=[Limbs(np.array(t.stems), np.array(t.centre), t.size) for t in tips.values()],
    )
    recovered = sorted(outcome.recovered)
    poses = [outcome.recovered[at].pose for at in recovered]
    nodes = len(deformation_graph.nodes)
    return Recovery(
        frames=frames,
        uncovered=uncovered,
        failed=outcome.failed,
        usual=outcome.usual,
        recovered=np.array(recovered, np.int32),
        uncovered_after=np.array([outcome.recovered[at].uncovered for at in recovered]),
        rotation=np.array([p.rotation for p in poses]).reshape(len(recovered), nodes, 3, 3),
        translation=np.array([p.translation for p in poses]).reshape(len(recovered), nodes, 3),
    )
