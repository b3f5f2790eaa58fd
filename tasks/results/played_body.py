"""The moving body of the report, packed apart from the page, so that it waits for no figure and no error."""

import json
from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.appearance import Appearance
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.schemas.results.played_body import PlayedBody, PlayedBodyParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED
from kinetree.tasks.results.formats.names import in_words
from kinetree.tasks.results.glb import NO_APPEARANCE
from kinetree.tasks.results.page.scene import Limits, scene
from kinetree.tasks.results.page.surface_colours import surface_colours


@task()
def played_body(
    skeleton: Skeleton,
    intervals: Intervals,
    leaves: Leaves,
    up_direction: UpDirection,
    excerpt: Excerpt,
    coarse_mesh: tuple[CoarseMesh, ...],
    alignment: Mapping[int, Alignment],
    params: PlayedBodyParams,
    assumed_joints: AssumedJoints = NOTHING_ASSUMED,
    appearance: Appearance = NO_APPEARANCE,
) -> PlayedBody:
    """Reduces body, skeleton and input in the frames that play to what a page can hold (ours)."""
    limits = Limits(len(excerpt.frames), params.vertices, coarse_mesh[0].limit)
    inputs = dict(zip(excerpt.frames, coarse_mesh, strict=True))
    assumed = [(in_words(joint.anatomy), joint.child, joint.place) for joint in assumed_joints.joints]
    colours = surface_colours(appearance, len(skeleton.vertices))
    body = scene(skeleton, alignment, inputs, leaves, intervals, limits, up_direction.axis, None, assumed, colours)
    return PlayedBody(
        description=json.dumps(body.description),
        omitted=body.omitted,
        block=np.frombuffer(body.packing.stream, dtype=np.uint8),
        size=body.packing.size,
        checksum=body.packing.checksum,
        reference_vertex=body.reference_vertex,
        axes=body.axes,
    )
