"""What a comparison of two skeletons holds, without and with a truth."""

import numpy as np
import pytest
from results.comparison_graphs import without
from results.rigged_bodies import spider

from kinetree.errors import InputError
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.comparison import ComparedRun, Comparison
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.comparison import Frames, check_sequence, compared_run, comparison
from kinetree.tasks.views.results import comparison_remarks, comparison_rows


def compared(a: Skeleton, b: Skeleton, limit: float = 0.05) -> Comparison:
    runs = tuple(compared_run(name, "m", s, None, 1.0) for name, s in (("one", a), ("two", b)))
    return comparison((runs[0], runs[1]), (a, b), None, [], limit)


def moved(by: float) -> Skeleton:
    """The spider with all joints moved by a share of its size."""
    return spider(positions=spider().positions + by * np.ptp(spider().vertices, axis=0).max() * np.array([1.0, 0.0, 0.0]))


def test_skeleton_is_itself() -> None:
    same = compared(spider(), spider())
    assert [(pair.a, pair.b) for pair in same.pairs] == [(name, name) for name in spider().names]
    assert same.mean_percent == 0.0
    assert same.only_a == same.only_b == ()
    assert same.truth == ""


def test_distance_is_a_share_of_the_body() -> None:
    apart = compared(spider(), moved(0.03))
    assert apart.mean_percent == pytest.approx(3.0)
    assert apart.distance.shape == (12, 7)
    assert compared(spider(), moved(0.06)).pairs == ()


def test_joint_of_one_run_alone_is_named_with_the_nearest_of_its_kind() -> None:
    alone = compared(spider(), without(spider(), "foot", "spur", "knee"))
    assert [(joint.name, joint.kind) for joint in alone.only_a] == [("knee", "joint"), ("foot", "leaf"), ("spur", "leaf")]
    assert alone.only_a[0].nearest == "arm"
    assert compared(without(spider(), "hand", "arm", "foot", "spur", "knee"), spider()).only_b[0].nearest is None


def test_remarks_say_the_rule_and_the_joints_of_one_run_alone() -> None:
    lines = comparison_remarks(compared(spider(), without(spider(), "tail")))
    assert lines[0] == "the same joint in both: 2 of 2 and 2, mean distance 0.00 % of the height"
    assert lines[1].startswith("only in A: leaf tail (nearest ")
    assert "not farther than 5 % of the height" in lines[-1]


def test_rows_of_the_truth_stand_only_where_there_is_one() -> None:
    names = [name for name, *_ in comparison_rows(compared(spider(), spider()))]
    assert "joints found" not in names
    assert names[0] == "method"


def test_other_frames_and_other_units_are_refused() -> None:
    short = spider(frames=tuple(range(1, 13)))
    with pytest.raises(InputError, match=r"one has 12 frames, 0 to 11 and two has 12 frames, 1 to 12; 2 frames are in one"):
        compared(spider(), short)
    with pytest.raises(InputError, match="one is in mm and two in cm; .* set sequence.unit"):
        compared(spider(), spider(unit="cm"))
    assert compared(spider(), spider(unit=None)).unit == "mm"


def frame(content: str, V: np.ndarray, kind: str = "file") -> Frames:
    mesh = Mesh(vertices=V, faces=[[0, 1, 2]], vertex_of_input=np.arange(len(V)), cleaning=Cleaning())
    return {0: Source.model_validate({"content": content, "path": "p", "kind": kind})}, {0: mesh}


def test_other_vertices_and_a_body_elsewhere_are_refused() -> None:
    V = np.eye(3)
    more = np.concatenate([V, [[0.5, 0.5, 0.5]]])
    check_sequence("one", frame("x", V), "two", frame("y", V + 0.01))
    check_sequence("one", frame("x", V), "two", frame("y", more, kind="silhouettes"))
    check_sequence("one", frame("x", V), "two", frame("x", V))
    with pytest.raises(InputError, match="frame 0 has 3 vertices in one and 4 in two; they are not runs of the same sequence"):
        check_sequence("one", frame("x", V), "two", frame("y", more))
    with pytest.raises(InputError, match=r"frame 0: the bodies of one and two lie \d+ % of their size apart"):
        check_sequence("one", frame("x", V), "two", frame("y", 1000 * V))


def test_run_without_a_truth_has_no_scores() -> None:
    run = compared_run("one", "m", spider(), None, 1.0)
    assert run == ComparedRun(name="one", method="m", joints=2, leaves=4, bones=6, frames=12, seconds=1.0)
