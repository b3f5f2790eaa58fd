"""What the surface shows: parts that slid along it are none, parts that bend it are."""

from collections.abc import Iterable

import numpy as np
import pytest
from articulated import Known, chain
from limbs import rotation
from shipped import EVIDENCE, PRUNING

from kinetree.tasks.numerics.geometry.closest_point import projected
from kinetree.tasks.numerics.structure import joint_evidence as numerics
from kinetree.tasks.numerics.structure.joint_evidence import FrameEvidence, least_evident_joint
from kinetree.tasks.numerics.structure.part_tree import MovingParts, MovingSurface, part_tree
from kinetree.tasks.numerics.structure.pruning import pruned

FRAMES = 4
X, Z = (1.0, 0.0, 0.0), (0.0, 0.0, 1.0)
MOVED = rotation((1.0, 2.0, 3.0), 0.8)


def turned(axis: tuple[float, float, float], degrees: float) -> np.ndarray:
    """(frame, part, 3, 3) the upper part turns, more in every frame."""
    turn = np.tile(np.eye(3), (FRAMES, 2, 1, 1))
    for f in range(FRAMES):
        turn[f, 1] = rotation(axis, np.deg2rad(degrees) * f / (FRAMES - 1))
    return turn


def looked_at(aligned: Known, true: Known, moved: np.ndarray | None = None) -> tuple[MovingSurface, MovingParts, FrameEvidence]:
    """The aligned body before frames that show the true one, both moved as a whole."""
    M = np.eye(3) if moved is None else moved
    x, goal = aligned.x @ M.T, true.x @ M.T
    residual = np.stack([projected(a, b, true.F).distance for a, b in zip(x, goal, strict=True)])
    parts = MovingParts(aligned.label, M @ aligned.R, aligned.t @ M.T, aligned.residual)
    evidence = FrameEvidence.of(np.ones(residual.shape), residual, lambda t: (goal[t], true.F), EVIDENCE)
    return MovingSurface(aligned.V, aligned.F, x, aligned.area), parts, evidence


def least(aligned: Known, true: Known, moved: np.ndarray | None = None) -> int:
    body, parts, evidence = looked_at(aligned, true, moved)
    return least_evident_joint(body, parts, part_tree(body, parts), evidence)


def otherwise(turn: np.ndarray) -> Known:
    """The same tube in other triangles."""
    return chain((1.0,), turn, around=23, along=37)


@pytest.mark.parametrize("moved", [None, MOVED], ids=["in place", "moved as a whole"])
def test_part_that_slid_about_a_round_limb_is_not_shown(moved: np.ndarray | None) -> None:
    still = otherwise(turned(Z, 0.0))
    assert least(chain((1.0,), turned(Z, 9.0)), still, moved) == 1


@pytest.mark.parametrize("moved", [None, MOVED], ids=["in place", "moved as a whole"])
@pytest.mark.parametrize("degrees", [6.0, 20.0])
def test_part_that_bends_is_shown(degrees: float, moved: np.ndarray | None) -> None:
    bent = turned(X, degrees)
    assert least(chain((1.0,), bent), otherwise(bent), moved) == -1


def test_part_that_bends_in_the_alignment_alone_is_not_shown() -> None:
    assert least(chain((1.0,), turned(X, 4.0)), otherwise(turned(X, 0.0))) == 1


def test_what_makes_a_joint_evident_can_be_set() -> None:
    bent = turned(X, 20.0)
    body, parts, evidence = looked_at(chain((1.0,), bent), otherwise(bent))
    tree = part_tree(body, parts)
    tested = EVIDENCE._replace(clear_motion=1e9)
    for settings, least_evident in (
        (EVIDENCE._replace(misfit_ratio=1e9, misfit_ratio_if_moving=1e9), -1),
        (tested._replace(misfit_ratio_if_moving=1e9), -1),
        (tested._replace(misfit_ratio=1e9), 1),
    ):
        assert least_evident_joint(body, parts, tree, evidence._replace(settings=settings)) == least_evident


def test_piece_is_laid_on_a_frame_once_and_again_by_other_settings(monkeypatch: pytest.MonkeyPatch) -> None:
    bent = turned(X, 20.0)
    body, parts, evidence = looked_at(chain((1.0,), bent), otherwise(bent))
    tree, laid, registered = part_tree(body, parts), [], numerics._registered
    monkeypatch.setattr(numerics, "_registered", lambda *given: (laid.append(given), registered(*given))[1])
    tested = evidence._replace(settings=EVIDENCE._replace(clear_motion=1e9))
    first = least_evident_joint(body, parts, tree, tested), len(laid)
    assert len(laid) > 0
    assert (least_evident_joint(body, parts, tree, tested), len(laid)) == first
    longer = tested._replace(settings=tested.settings._replace(rounds=tested.settings.rounds + 1))
    least_evident_joint(body, parts, tree, longer)
    assert len(laid) == 2 * first[1]


def test_handful_of_vertices_shows_nothing() -> None:
    bent = turned(X, 20.0)
    body = chain((1.0,), bent)
    few = np.zeros(len(body.V), np.int64)
    few[np.argsort(-body.V[:, 2], kind="stable")[:8]] = 1
    assert least(body._replace(label=few), otherwise(bent)) == 1


def test_body_that_only_slid_is_one_part_and_one_that_bends_two() -> None:
    bent = turned(X, 20.0)
    slid, true = chain((1.0,), turned(Z, 9.0)), otherwise(turned(Z, 0.0))
    tips = np.zeros(0, np.int64)
    for aligned, there, count in ((slid, true, 1), (chain((1.0,), bent), otherwise(bent), 2)):
        body, parts, evidence = looked_at(aligned, there)
        assert pruned(body, parts, tips, evidence, settings=PRUNING._replace(ratio=0.0)).parts.R.shape[1] == count


def scored_so(scores: Iterable[float], monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """Joints have these scores, one after the other · the smaller parts that were asked for, as they are."""
    told, asked = iter(scores), []

    def scored(*of: object) -> float:
        asked.append(int(str(of[4])))
        return next(told)

    monkeypatch.setattr(numerics, "_score", scored)
    return asked


@pytest.mark.parametrize(("first", "second", "goes"), [(2.0, 1.3, True), (np.inf, 1.3, False), (np.inf, 1.05, True)])
def test_joint_needs_less_where_another_moves_clearly(
    first: float, second: float, goes: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    body, parts, evidence = looked_at(chain((-2.0, 1.0)), chain((-2.0, 1.0)))
    asked = scored_so((first, second), monkeypatch)
    found = least_evident_joint(body, parts, part_tree(body, parts), evidence)
    assert found == (asked[1] if goes else -1)


@pytest.mark.parametrize(
    ("scores", "partner", "goes"),
    [
        ((2.0, 1.3), None, 1),
        ((2.0, 1.3), (-1, 2, 1), None),
        ((1.4, 1.3), (-1, 2, 1), 1),
        ((1.3, 2.0), (-1, 2, 1), None),
        ((2.0, 1.3), (-1, -1, -1), 1),
    ],
    ids=["no partners known", "the partner is shown", "neither is", "the first one's is", "none has one"],
)
def test_joint_whose_mirror_image_is_shown_stays(
    scores: tuple[float, float], partner: tuple[int, ...] | None, goes: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    body, parts, evidence = looked_at(chain((-2.0, 1.0)), chain((-2.0, 1.0)))
    asked = scored_so(scores, monkeypatch)
    found = least_evident_joint(body, parts, part_tree(body, parts), evidence, None if partner is None else np.array(partner))
    assert found == (-1 if goes is None else asked[goes])


def test_pruning_asks_for_the_mirror_image(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of two joints of mirrored limbs the frames show one; alone it would go."""
    body, parts, evidence = looked_at(chain((-2.0, 2.0)), chain((-2.0, 2.0)))
    sides = [int(np.argmin(np.linalg.norm(body.V - [x, 0.0, 0.0], axis=1))) for x in (1.0, -1.0)]
    tips = np.array([body.V[:, 2].argmin(), body.V[:, 2].argmax(), *sides])

    def score(body: MovingSurface, parts: MovingParts, *of: object) -> float:
        return 2.0 if body.V[parts.label == of[2], 2].mean() > 0 else 1.3

    monkeypatch.setattr(numerics, "_score", score)
    count = [
        pruned(body, parts, ends, evidence, settings=PRUNING._replace(degrees=0.0, ratio=0.0)) for ends in (tips, tips[1:])
    ]
    assert [left.parts.R.shape[1] for left in count] == [3, 2]


@pytest.mark.parametrize(("scores", "goes"), [((np.nan, 2.0), None), ((np.nan, 1.3), 1), ((np.nan, np.nan), None)])
def test_part_that_no_frame_sees_stays(scores: tuple[float, float], goes: int | None, monkeypatch: pytest.MonkeyPatch) -> None:
    body, parts, evidence = looked_at(chain((-2.0, 1.0)), chain((-2.0, 1.0)))
    asked = scored_so(scores, monkeypatch)
    found = least_evident_joint(body, parts, part_tree(body, parts), evidence)
    assert found == (-1 if goes is None else asked[goes])


def test_of_joints_without_a_shown_mirror_image_the_least_evident_goes(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least of all has one."""
    body, parts, evidence = looked_at(chain((-2.0, 1.0, 3.0)), chain((-2.0, 1.0, 3.0)))
    asked = scored_so((1.1, 2.0, 1.3), monkeypatch)
    found = least_evident_joint(body, parts, part_tree(body, parts), evidence, np.array([-1, 2, 1, -1]))
    assert found == asked[2]
