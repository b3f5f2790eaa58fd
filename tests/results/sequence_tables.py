"""A table over three sequences: one with a truth, one without, one that failed."""

import numpy as np
from results.rigged_bodies import spider

from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.evaluation import Evaluation, Summary
from kinetree.schemas.results.outcomes import Outcomes, SequenceOutcome
from kinetree.schemas.results.verdict import Finding, Verdict
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.sequence_figures import sequence_figures
from kinetree.tasks.results.sequence_table import sequence_table

FILES = ("report.html", "skeleton.json")
WALK = SequenceOutcome(
    name="walk & <b>", output="walk & <b>", method="a", status="done", seconds=12.5, files=FILES, has_result=True,
    remarks=("skeleton: a <remark>",),
)  # fmt: skip
DANCE = SequenceOutcome(name="=dance", output="=dance", method="a", status="done", seconds=2.5, files=FILES, has_result=True)
TORN = SequenceOutcome(name="torn", output="torn", status="failed", failures=("mesh[frame=3]: MeshError: <torn>", "another"))


def evaluated(summary):
    empty = np.zeros((0, 0))
    return Evaluation(
        truth="truth.json" if summary else "", frames=(), true_frames=0, unit=None, height=0.0, joints=(), spurious=(),
        summary=summary, error=empty, detection=np.zeros(0), distance=np.zeros(0),
    )  # fmt: skip


def judged(body):
    """Good except for one joint."""
    weak = Finding(kind="weak", severity="fault", joints=body.names[1:2], amount=0.2)
    return Verdict(
        level="except", findings=(weak,), frames=body.frames, joints=body.names,
        labels=(body.names[0], "left <shoulder>", *body.names[2:]),
        worst=0.01, state=np.zeros((len(body.frames), len(body.names)), np.int32),
    )  # fmt: skip


def figures_of(summary=None):
    body = spider()
    zero = np.zeros(len(body.frames))
    inlier = np.arange(len(body.frames)) > 1
    sure = FrameConfidence(frames=body.frames, residual=zero, uncovered=zero, unreliable=zero, inlier=inlier)
    return sequence_figures(body, evaluated(summary), sure, UpDirection(up="z", confidence=1.0), judged(body))


def table():
    outcomes = Outcomes(sequences=(DANCE, TORN, WALK))
    scores = Summary(scored=5, found=4, spurious=1, error=0.25, percent=1.5)
    return sequence_table(
        outcomes, {member: figures_of(scores if member == 2 else None) for member in outcomes.members("sequence", ())}
    )
