"""The moving body of the report, packed apart from the page, so that neither pictures nor tables wait for it."""

import json
from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.array import Floats
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.results.appearance import Appearance
from kinetree.schemas.results.assumed_joints import AssumedJoints
from kinetree.schemas.results.coarse_mesh import CoarseMesh
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.schemas.results.played_body import PlayedBody, PlayedBodyParams
from kinetree.schemas.results.surface_error import SurfaceError
from kinetree.schemas.results.verdict import Verdict
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.topology.intervals import Intervals
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.results.verdict import VerdictSettings
from kinetree.tasks.results.formats.assumed import NOTHING_ASSUMED
from kinetree.tasks.results.formats.names import in_words
from kinetree.tasks.results.glb import NO_APPEARANCE
from kinetree.tasks.results.page.scene import Limits, Scene, Trust, scene
from kinetree.tasks.results.page.surface_colours import surface_colours


@task()
def played_body(
    skeleton: Skeleton,
    intervals: Intervals,
    leaves: Leaves,
    up_direction: UpDirection,
    surface_error: Mapping[int, SurfaceError],
    verdict: Verdict,
    error_bars: ErrorBars,
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
    size = float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0)))
    error = {frame: np.asarray(e.distance) for frame, e in surface_error.items()}
    share = VerdictSettings().wrong
    trust = Trust(verdict.labels, error, share * size, share, verdict.state, bounds_in_frames(error_bars))
    assumed = [(in_words(joint.anatomy), joint.child, joint.place) for joint in assumed_joints.joints]
    colours = surface_colours(appearance, len(skeleton.vertices))
    body = scene(skeleton, alignment, inputs, leaves, intervals, limits, up_direction.axis, None, trust, assumed, colours)
    return PlayedBody(
        description=json.dumps(body.description), omitted=body.omitted, block=np.frombuffer(body.block, dtype=np.uint8)
    )


def played_scene(played: PlayedBody) -> Scene:
    """What the page contains of it."""
    return Scene(json.loads(played.description), played.block.tobytes(), played.omitted)


def bounds_in_frames(bars: ErrorBars) -> Floats | None:
    """(frame, joint) bound of every joint, in a frame as much larger as its expected error is; None where nothing is known."""
    return np.asarray(bars.in_frame * (bars.bound / bars.expected)) if bars.cuts else None
