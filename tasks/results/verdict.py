"""Whether the result can be relied on."""

from collections.abc import Mapping

import numpy as np

from kinetree.pipeline.task import task
from kinetree.schemas.registration.frame_confidence import FrameConfidence
from kinetree.schemas.results.surface_error import SurfaceError
from kinetree.schemas.results.verdict import Finding, Verdict
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.numerics.results import verdict as numerics
from kinetree.tasks.numerics.results.evaluation.body import longest_side
from kinetree.tasks.results.formats.names import readable_names


@task()
def verdict(
    skeleton: Skeleton,
    joint_names: JointNames,
    frame_confidence: FrameConfidence,
    surface_error: Mapping[int, SurfaceError],
    error_bars: ErrorBars,
) -> Verdict:
    """Says whether the result is good, good except for some parts and frames, or not to be used (ours)."""
    side = max(longest_side(skeleton.vertices), 1e-300)
    size = max(float(np.linalg.norm(np.ptp(skeleton.vertices, axis=0))), 1e-300)
    errors = [surface_error[frame] for frame in skeleton.frames]
    inlier = dict(zip(frame_confidence.frames, frame_confidence.inlier.tolist(), strict=True))
    pairs, unpaired = numerics.sided(joint_names.anatomy, skeleton.parents)
    skin, surface = (np.array([getattr(e, name) for e in errors]) / size for name in ("skin", "surface"))
    found = numerics.verdict(
        numerics.Evidence(
            skin=skin,
            surface=surface,
            outside=np.array([e.outside for e in errors]) / size,
            distance=np.array([np.sqrt(np.mean(np.asarray(e.distance, np.float64) ** 2)) for e in errors]) / size,
            inlier=np.array([inlier.get(frame, True) for frame in skeleton.frames]),
            confidence=np.array(skeleton.confidence),
            support=np.array(skeleton.support),
            degrees=np.array(skeleton.degrees),
            turning=np.array([kind == "joint" for kind in skeleton.kinds]),
            length=skeleton.lengths / size,
            expected=np.array(error_bars.expected) / side,
            bound=np.array(error_bars.bound) / side,
            by_shape=np.array([known == "shape" for known in error_bars.evidence]),
            by_narrowing=np.array([known == "narrowing" for known in error_bars.evidence]),
            by_mirror=np.array([known == "mirror" for known in error_bars.evidence]),
            pairs=pairs,
            unpaired=unpaired,
        )
    )
    return Verdict(
        level=found.level,
        findings=tuple(
            Finding(
                kind=f.kind,
                severity=f.severity,
                frames=tuple(skeleton.frames[t] for t in f.frames),
                joints=tuple(skeleton.names[j] for j in f.joints),
                amount=f.amount,
                bounds=f.bounds,
            )
            for f in found.findings
        ),
        frames=skeleton.frames,
        joints=skeleton.names,
        labels=readable_names(joint_names),
        worst=float(np.maximum(skin, surface).max(initial=0.0)),
        state=found.state,
    )
