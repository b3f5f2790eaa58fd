"""What the task keeps of a body whose parts are known."""

import numpy as np
import pytest
from articulated import Known, chain, swings, three_arms
from matplotlib.text import Text

from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.reference import Reference
from kinetree.schemas.structure.kinematic_tree import KinematicTreeParams
from kinetree.schemas.structure.rigid_parts import RigidParts
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.schemas.structure.traces import Traces, TracesParams
from kinetree.schemas.topology.leaves import Leaves
from kinetree.tasks.results.plots.traces import cones, lengths, merging, structure
from kinetree.tasks.structure.kinematic_tree import kinematic_tree
from kinetree.tasks.structure.traces import traces

FIRST = 10


def told(body: Known, tips: tuple[int, ...] = (), trust: np.ndarray | None = None, degrees: float = 8.0) -> Traces:
    return both(body, tips, trust, degrees)[1]


def both(
    body: Known, tips: tuple[int, ...] = (), trust: np.ndarray | None = None, degrees: float = 8.0
) -> tuple[Skeleton, Traces]:
    count = len(body.x)
    frames = tuple(range(FIRST, FIRST + count))
    reference = Reference(
        frames=frames, frame=FIRST, vertices=body.V, faces=body.F, size=float(np.sqrt(body.area.sum())), fixed=True,
        leaves=len(tips), free=True, score=np.zeros(count), before=np.arange(-1, count - 1),
    )  # fmt: skip
    parts = RigidParts(
        frames=frames, label=body.label, rigid=np.ones(len(body.V)), rotation=body.R, translation=body.t, residual=body.residual
    )
    zero, one = np.zeros(len(body.V)), np.ones(len(body.V))
    aligned = {
        f: Alignment(vertices=x, residual=zero, stretch=one, trust=one if trust is None else trust[k], uncovered=0.0)
        for k, (f, x) in enumerate(zip(frames, body.x, strict=True))
    }
    leaves = Leaves(
        frames=frames, rows=np.zeros((len(tips), count), int),
        positions=np.broadcast_to(body.V[list(tips), None], (len(tips), count, 3)), kept=np.ones((1, len(tips)), bool),
        lost=np.zeros(0, int), lost_begin=np.zeros(0, int), lost_end=np.zeros(0, int),
    )  # fmt: skip
    sequence = Sequence(frames=frames, fps=25.0, unit="mm")
    found = kinematic_tree(reference, parts, aligned, {}, leaves, sequence, KinematicTreeParams(degrees=degrees))
    return found, traces(reference, aligned, leaves, parts, found, TracesParams(rings=20))


def ends(body: Known) -> tuple[int, ...]:
    return tuple(int(np.argmax(body.V @ [np.cos(a), np.sin(a), 0.0])) for a in (0, 2 * np.pi / 3, 4 * np.pi / 3))


def test_cones_of_three_arms_lie_around_their_tips_and_bear_their_joints() -> None:
    body = three_arms()
    found = told(body, ends(body))
    assert found.tips.tolist() == list(ends(body))
    assert found.ring[[0, 1, 2], found.tips].tolist() == [0, 0, 0]
    first = found.joint_of_annulus[:, 0]
    assert len(set(first.tolist())) == 3
    for k in range(3):
        where = int(np.nanargmax(found.merge[k]))
        assert found.joint_of_annulus[k, max(where - 2, 0)] == first[k]
        assert found.joint_of_annulus[k, min(where + 3, int((found.run[k] >= 0).sum()) - 1)] == 0
        assert found.merge[k, where] > found.threshold


def test_every_part_that_stays_has_its_joint_and_a_bone_of_one_length() -> None:
    body = three_arms()
    found = told(body, ends(body))
    assert sorted(found.joint.tolist()) == [0, 1, 3, 5]
    assert found.kept.all()
    assert found.variation.max() < 0.5
    assert found.length[[1, 3, 5]] == pytest.approx(12, abs=1.0)


def test_a_part_that_hardly_turns_has_no_joint() -> None:
    turn = swings(16, 2, degrees=30.0)
    turn[:, 1] = swings(16, 2, degrees=2.0)[:, 1]
    found = told(chain((0.0,), turn))
    assert sorted(found.joint.tolist()) == [-1, 0]


def test_a_body_without_leaves_has_no_cones_and_one_without_motion_no_borders() -> None:
    body = chain((0.0,), swings(12, 2))
    found = told(body)
    assert (len(found.tips), found.ring.shape, found.run.shape) == (0, (0, len(body.V)), (0, 20))
    assert len(found.pair) == 1
    stiff = body._replace(label=np.zeros(len(body.V), int), R=body.R[:, :1], t=body.t[:, :1])
    alone = told(stiff._replace(x=np.stack([body.V] * 12)))
    assert (len(alone.pair), alone.joint.tolist(), alone.length.tolist()) == (0, [0], [0.0])


@pytest.mark.parametrize("stiff", [False, True])
def test_pictures_say_where_there_is_nothing_to_see(stiff: bool) -> None:
    body = chain((0.0,), swings(8, 2))
    if stiff:
        body = body._replace(label=np.zeros(len(body.V), int), R=body.R[:, :1], t=body.t[:, :1], x=np.stack([body.V] * 8))
    shown = dict(zip(("skeleton", "traces"), both(body), strict=True))
    figures = [draw(lambda name, frame=None: shown[name], [FIRST]) for draw in (cones, merging, structure, lengths)]
    words = [" ".join(text.get_text() for text in figure.findobj(Text)) for figure in figures]
    assert "no cones" in words[0]
    assert "no cones" in words[1]
    assert ("0 joints" if stiff else "1 joints") in words[2]
    assert ("no bones" in words[3]) == stiff


def test_frames_that_are_not_trusted_and_a_second_run_change_nothing() -> None:
    body = three_arms()
    trust = np.ones(body.x.shape[:2])
    trust[3] = 0.0
    wild = body.x.copy()
    wild[3] += np.random.default_rng(0).normal(size=body.V.shape)
    one, other = (told(body._replace(x=wild), ends(body), trust) for _ in range(2))
    for name in Traces.array_fields():
        assert getattr(one, name).tobytes() == getattr(other, name).tobytes()
    found = told(body, ends(body))
    assert one.run.tolist() == found.run.tolist()
