"""Error bars as the task gives them, and of methods that have none."""

import numpy as np
import pytest
from fitting import FIRST, FRAMES, arms, articulation

from kinetree.pipeline import views
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.structure.error_bars import ErrorBars
from kinetree.schemas.structure.kinematic_tree import KinematicTree
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.structure.error_bars import error_bars, unknown_error_bars
from kinetree.tasks.structure.skeleton import skeleton

SEQUENCE = Sequence(frames=tuple(range(FIRST, FIRST + FRAMES)), fps=25.0, unit="mm")
ENDS = [0, 2]
"""Root and leaf."""


def both(**evidence: float) -> tuple[Skeleton, KinematicTree]:
    tree = articulation(arms()[0])
    told = {name: np.full(5, value) for name, value in evidence.items() if name != "cuts"}
    tree = tree.model_copy(update={**told, "cuts": int(evidence.get("cuts", 1))})
    return skeleton(tree, (), (), SEQUENCE), tree


def test_joints_have_error_bars_and_root_and_leaves_none() -> None:
    found = error_bars(*both(drift=0.1, spread=0.05, joint_residual=0.02, cuts=4))
    assert found.joints == ("root", "a", "a_end", "b", "c")
    assert found.cuts == 4
    assert np.isnan(found.expected[ENDS]).all()
    assert np.isnan(found.in_frame[:, ENDS]).all()
    assert (found.bound[[1, 3, 4]] > found.expected[[1, 3, 4]]).all()
    assert found.drift[1] == pytest.approx(0.1)


def test_frames_in_doubt_have_wider_bars() -> None:
    found = error_bars(*both(drift=0.1, spread=0.05, cuts=4))
    doubted, sure = found.in_frame[6, 1], found.in_frame[5, 1]
    assert doubted > 1.2 * sure
    assert found.in_frame[6, 3] == pytest.approx(found.in_frame[5, 3])


def test_cuts_that_are_farther_apart_are_a_larger_error_and_one_cut_says_nothing_of_them() -> None:
    near, far = (error_bars(*both(drift=0.1, spread=s, cuts=4)).expected[1] for s in (0.01, 0.2))
    assert far > near
    alone = [error_bars(*both(drift=0.1, spread=s)).expected[1] for s in (0.01, np.nan)]
    assert alone[0] == alone[1]


def test_a_joint_whose_vertices_are_given_has_an_error_that_grows_with_the_radius_of_its_border() -> None:
    skeleton_, tree = both(drift=0.0, spread=0.0, joint_residual=0.0, cuts=4)

    def expected(radius: float, *, is_given: bool) -> float:
        border = np.array([np.nan, radius, np.nan, radius, radius])
        return float(error_bars(skeleton_, tree.model_copy(update={"border_radius": border, "is_given": is_given})).expected[1])

    assert expected(80.0, is_given=True) == pytest.approx(2.0 * expected(40.0, is_given=True), rel=0.01)
    assert expected(80.0, is_given=False) == expected(40.0, is_given=False)


def test_other_methods_say_that_nothing_is_known() -> None:
    found = unknown_error_bars(both()[0])
    assert found.cuts == 0
    assert np.isnan(found.expected).all()
    assert views.text(found) == ("no errors are known",)
    assert views.remarks(found) == ()


def test_text_says_error_bound_and_evidence_of_every_joint() -> None:
    found = error_bars(*both(drift=0.1, spread=0.05, joint_residual=0.02, agreeing=3, support=7, cuts=4))
    lines = views.text(found)
    assert [line.split()[0] for line in lines] == ["a", "b", "c"]
    assert f"±{found.expected[1]:.2g}, 90 % below {found.bound[1]:.2g}" in lines[0]
    assert "spread 0.05 over 3 of 4 cuts" in lines[0]
    assert "surface offset" not in lines[0]
    assert "mirror image" not in lines[0]
    assert type(found) is ErrorBars
    unlike = views.text(found.model_copy(update={"asymmetry": np.full(5, 0.03)}))
    assert "residual 0.02, bone 0.03 unlike its mirror image" in unlike[0]


def test_the_tree_in_words_has_the_error_bars_and_the_drift_where_none_are_known() -> None:
    body, tree = both(drift=0.1, spread=0.05, joint_residual=0.02, cuts=4)
    bars = error_bars(body, tree)

    def beside(known: ErrorBars) -> list[str]:
        lines = views.text(body, lambda cls: known if cls is ErrorBars else None)
        return [line for line in lines if "turns" in line]

    assert f"±{bars.expected[1]:.2g} mm (90 %: {bars.bound[1]:.2g})" in beside(bars)[0]
    assert "±0.1 mm," in beside(unknown_error_bars(body))[0]
    offset = bars.model_copy(update={"surface_offset": np.full(5, 0.02)})
    assert "surface offset" not in beside(bars)[0]
    assert "surface offset 0.02 mm, supported" in beside(offset)[0]
    assert "residual 0.02, surface offset 0.02, seen" in views.text(offset)[0]
    large = bars.model_copy(update={"bound": np.full(5, 123.4)})
    assert "(90 %: 120)" in beside(large)[0]


@pytest.mark.parametrize(
    ("field", "kind", "words", "share"),
    [
        ("neck_joints", "shape", "by the shape alone", 0.4),
        ("narrowing_joints", "narrowing", "by a narrowing of the limb alone", 0.5),
        ("mirrored_joints", "mirror", "by the other side alone", 0.55),
    ],
)
def test_a_joint_that_no_motion_shows_says_so_wherever_its_evidence_stands(
    field: str, kind: str, words: str, share: float
) -> None:
    body, tree = both(drift=0.1, spread=0.05, joint_residual=0.02, cuts=4)
    tree = tree.model_copy(update={"border_radius": np.full(5, 2.0)})
    bars = error_bars(body, tree.model_copy(update={field: (3,)}))
    assert bars.evidence == (None, "motion", None, kind, "motion")
    assert [(words in line, "drift" in line) for line in views.text(bars)] == [(False, True), (True, False), (False, True)]
    lines = views.text(body, lambda cls: bars if cls is ErrorBars else None)
    assert [j for j, line in enumerate(lines) if f"{words}, no turn measured" in line] == [3]
    moving = error_bars(body, tree)
    assert bars.expected[3] == pytest.approx(share * 2.0), "it goes by the radius alone"
    assert bars.expected[1] == moving.expected[1] != bars.expected[3]
    assert unknown_error_bars(body).evidence == (None,) * 5


def test_a_joint_that_surfaces_show_is_expected_at_half_the_error_of_another() -> None:
    body, tree = both(drift=0.1, spread=0.05, joint_residual=0.02, cuts=4)
    plain, shown = error_bars(body, tree), error_bars(body, tree.model_copy(update={"end_joints": (3,)}))
    np.testing.assert_allclose(shown.expected[[1, 3, 4]], plain.expected[[1, 3, 4]] * [1.0, 0.5, 1.0])
    assert shown.evidence[3] == "motion"


def test_bones_of_a_pair_of_limbs_are_compared_and_not_where_one_of_both_is_placed_by_the_other() -> None:
    skeleton_, tree = both(drift=0.1, spread=0.05, joint_residual=0.02, cuts=4)
    told = tree.model_copy(update={"partner": np.array([-1, -1, -1, 4, 3])})
    length = skeleton_.lengths
    found = error_bars(skeleton_, told)
    assert found.asymmetry[3] == found.asymmetry[4] == pytest.approx(abs(length[3] - length[4]))
    assert np.isnan(found.asymmetry[:3]).all()
    assert (found.expected[[3, 4]] != error_bars(skeleton_, tree).expected[[3, 4]]).all()
    assert np.isnan(error_bars(skeleton_, told.model_copy(update={"mirrored_joints": (4,)})).asymmetry).all()
