"""A take that grows: frames outside `sequence.learn_from` are posed, and change no frame that was there before."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kinetree.pipeline.inspect import Pipeline
from kinetree.schemas.input.source import Source
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks import METHODS
from kinetree.tasks.results.truth import synthetic

THERE = 8
GROWN = 10
SMALL: dict[str, Any] = {
    "geodesics": {"bases": 40},
    "deformation_graph": {"nodes": 120},
    "rigid_parts": {"patches": 100},
    "compute": {"executor": "sync"},
}


MADE = ("skeleton", "frame_confidence", "coarse_mesh")
GATHERS = {"sequence", "tracking_order", "frame_confidence", "skeleton", "excerpt"}


class Heard:
    """The nodes that a run computed."""

    def __init__(self) -> None:
        self.ran: set[str] = set()

    def hear(self, event: Mapping[str, Any]) -> None:
        """One event."""
        if event["event"] == "finish":
            self.ran.add(event["node"])


class Take:
    """A generated body that walks, and its runs."""

    def __init__(self, output: Path) -> None:
        self.output = output

    def pipeline(self, frames: int, learn_from: str) -> Pipeline:
        """The default method over so many frames."""
        synth = {"figure": "human", "frames": GROWN, "vertices": 700}
        told = {"source": {"synth": synth, "frames": f":{frames}"}, "sequence": {"learn_from": learn_from}}
        return Pipeline.of({"output": str(self.output), **SMALL, **told})

    def run(self, frames: int, learn_from: str) -> set[str]:
        """Labels of the nodes that were computed to make the skeleton and what the report shows of each frame."""
        heard = Heard()
        self.pipeline(frames, learn_from).run(until=MADE, listeners=[heard])
        return heard.ran

    def artifacts(self, frames: int, learn_from: str) -> dict[str, str | None]:
        """The artifact of every node."""
        plan = self.pipeline(frames, learn_from).inspect(until=MADE).plan
        return {node.node: node.artifact for node in plan.nodes}


@pytest.fixture(scope="module")
def take(tmp_path_factory: pytest.TempPathFactory) -> tuple[Take, dict[str, str | None], Skeleton, set[str]]:
    """The take, the artifacts and the skeleton when it had eight frames, and what two more frames computed."""
    take = Take(tmp_path_factory.mktemp("growing") / "out")
    take.run(THERE, f":{THERE}")
    before = take.artifacts(THERE, f":{THERE}")
    skeleton = take.pipeline(THERE, f":{THERE}").artifact(Skeleton)
    return take, before, skeleton, take.run(GROWN, f":{THERE}")


def test_appended_frames_compute_themselves_and_the_gathers_of_all_frames(take: Any) -> None:
    *_, ran = take
    of_frames = {node for node in ran if "frame=" in node or "further=" in node}
    assert {node.rpartition("=")[2] for node in of_frames} == {"8]", "9]"}
    per_frame = [t for t in METHODS["mesoscopic"].tasks if t.over and t.over[-1] in ("frame", "further") and not t.on_request]
    passes = {t.name: 3 if "pass" in t.over else 1 for t in per_frame if not t.is_origin}
    assert len(of_frames) <= 2 * sum(passes.values())
    assert ran - of_frames == GATHERS


def test_artifacts_of_the_frames_before_stay_byte_for_byte(take: Any) -> None:
    here, before, _, _ = take
    after = here.artifacts(GROWN, f":{THERE}")
    assert {node: after[node] for node in before if node not in GATHERS} == {
        node: artifact for node, artifact in before.items() if node not in GATHERS
    }


def test_the_skeleton_is_the_same_where_it_was_and_posed_in_the_new_frames(take: Any) -> None:
    here, _, before, _ = take
    after = here.pipeline(GROWN, f":{THERE}").artifact(Skeleton)
    assert (after.frames, after.names) == (tuple(range(GROWN)), before.names)
    for name in ("positions", "rotation", "confidence"):
        assert getattr(after, name)[:THERE].tobytes() == getattr(before, name).tobytes()
    assert after.rest.tobytes() == before.rest.tobytes()
    step = np.linalg.norm(np.diff(after.positions, axis=0), axis=2).max(axis=1)
    assert step[THERE - 1 :].max() < 3 * np.median(step)
    off = _off_truth(after, here.pipeline(GROWN, f":{THERE}").artifact(Source, frame=0))
    assert off[THERE:].mean() < 1.2 * off[:THERE].mean(), "frames that nothing was learned from are posed as well"


def _off_truth(skeleton: Skeleton, source: Source) -> np.ndarray:
    """(frame,) mean distance between the joints and the true ones that they stand for, in the figure's unit."""
    true = np.array(synthetic(source.recipe).positions)[list(skeleton.frames)]
    joints = np.array(skeleton.positions)[:, np.array(skeleton.kinds) == "joint"]
    away = np.linalg.norm(joints[:, :, None] - true[:, None], axis=3)
    nearest = away.mean(axis=0).argmin(axis=1)
    return away[:, np.arange(len(nearest)), nearest].mean(axis=1)


def test_learning_from_all_frames_is_learning_from_those_there_are(take: Any) -> None:
    here, before, _, _ = take
    ran = here.run(THERE, ":")
    assert ran <= {"sequence", "tracking_order", "excerpt"}
    assert {n: a for n, a in here.artifacts(THERE, ":").items() if n != "sequence"} == {
        n: a for n, a in before.items() if n != "sequence"
    }


def test_an_appended_frame_that_is_learned_from_too_leaves_tracking_of_the_others_alone(tmp_path: Path) -> None:
    def ran(frames: int) -> set[str]:
        source = {"synth": {"figure": "human", "frames": 6, "vertices": 700}, "frames": f":{frames}"}
        heard = Heard()
        pipeline = Pipeline.of({"output": str(tmp_path), **SMALL, "source": source, "reference": {"frame": 2}})
        pipeline.run(until=("tracking",), listeners=[heard])
        return {node for node in heard.ran if node.startswith("tracking[")}

    assert len(ran(5)) == 5
    assert ran(6) == {"tracking[frame=5]"}
