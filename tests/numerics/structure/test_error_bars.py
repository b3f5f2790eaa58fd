"""Laws of the expected error: scale, growth with each piece of evidence and with doubt, and its fit."""

import numpy as np
import pytest

from kinetree.tasks.numerics.structure.error_bars import ErrorBarsSettings, JointFeatures, PowerLaw, error_bars, fitted

SETTINGS = ErrorBarsSettings(
    PowerLaw(0.5, 0.4, 0.5, 0.1, -0.5, -0.3, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0),
    PowerLaw(1.5, 0.2, 0.3, 0.1, -0.5, -0.3, 0.5, 0.2, 0.3, -0.1, 0.4, 0.0, 2.5),
    PowerLaw(0.3, 0.8, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 3.0),
    along_axis=0.1,
    end_joint=0.25,
    across_tube=0.3,
    across_narrowing=0.45,
    across_mirrored=0.7,
    alike=0.2,
    uncertain=2.0,
)


def features(scale: float = 1.0, **changed: np.ndarray) -> JointFeatures:
    evidence = {
        "drift": np.array([0.01, 0.02, 0.01]), "spread": np.array([0.004, 0.004, 0.008]),
        "residual": np.array([0.003, 0.003, 0.003]), "length": np.full(3, 0.2), "size": 1.0, "offset": np.full(3, np.nan),
        "degrees": np.full(3, 40.0), "resistance": np.full(3, 0.02), "hinge": np.full(3, np.nan),
        "below": np.zeros(3), "softness": np.full(3, 0.1), "radius": np.full(3, np.nan), "is_end_joint": np.zeros(3, np.bool_),
        "tube": np.full(3, np.nan), "narrowing": np.full(3, np.nan), "mirrored": np.full(3, np.nan),
        "asymmetry": np.full(3, np.nan), "confidence": np.ones((5, 3)), **changed,
    }  # fmt: skip
    unscaled = ("degrees", "resistance", "below", "softness", "is_end_joint", "confidence")
    return JointFeatures(**{n: value if n in unscaled else scale * value for n, value in evidence.items()})


def test_errors_scale_with_the_body_and_the_bound_with_the_error() -> None:
    one, large = error_bars(features(), 4, SETTINGS), error_bars(features(scale=1000.0), 4, SETTINGS)
    assert large.expected == pytest.approx(1000.0 * one.expected)
    assert one.bound == pytest.approx(2.0 * one.expected)
    assert one.expected[0] == pytest.approx(np.exp(0.5) * 0.01**0.4 * 0.004**0.5 * 0.003**0.1 / 40**0.5 / 0.2**0.3)


def test_more_drift_or_spread_is_more_error_and_one_cut_goes_by_drift() -> None:
    several, one = error_bars(features(), 4, SETTINGS).expected, error_bars(features(), 1, SETTINGS).expected
    assert several[0] < several[1] < several[2]
    assert one[0] == one[2] < one[1]


def test_a_joint_that_turns_more_or_has_a_longer_bone_is_known_better() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01)}
    turns = error_bars(features(degrees=np.array([0.0, 10.0, 90.0]), **same), 4, SETTINGS).expected
    assert turns[0] > turns[1] > turns[2]
    assert np.isfinite(turns).all()
    long = error_bars(features(length=np.array([0.05, 0.1, 0.4]), **same), 4, SETTINGS)
    assert long.expected[0] > long.expected[1] > long.expected[2]


def test_a_joint_that_no_other_cut_has_is_worse_than_one_whose_cuts_are_apart() -> None:
    spread = np.array([np.nan, 0.02, 0.004])
    found = error_bars(features(spread=spread, drift=np.full(3, 0.01)), 4, SETTINGS).expected
    assert found[0] > found[1] > found[2]
    assert np.isfinite(found).all()


def test_by_the_shipped_laws_a_joint_farther_from_its_place_on_the_surfaces_has_a_larger_bound() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01)}
    bars = error_bars(features(offset=np.array([0.002, 0.008, 0.032]), **same), 4)
    assert bars.bound[1] > 1.3 * bars.bound[0]
    assert bars.bound[2] > 1.3 * bars.bound[1]
    np.testing.assert_array_less(1.3 * bars.expected, bars.bound)


def test_a_joint_farther_from_its_place_on_the_surfaces_is_worse_and_one_without_such_a_place_goes_by_the_rest() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01)}
    hinge = np.full(3, 0.01)
    found = error_bars(features(offset=np.array([0.002, 0.008, np.nan]), hinge=hinge, **same), 4, SETTINGS)
    assert found.expected[1] == pytest.approx(2.0 * found.expected[0])
    assert found.expected[2] == pytest.approx(np.sqrt(1.0 / 0.008) * found.expected[1]), "as far off as the body is large"
    assert found.bound == pytest.approx(2.5 * found.expected)
    assert error_bars(features(**same), 4, SETTINGS).bound == pytest.approx(
        2.0 * error_bars(features(**same), 4, SETTINGS).expected
    )
    alone = [error_bars(features(offset=np.full(3, offset), **same), 1, SETTINGS).expected for offset in (0.002, 0.02)]
    assert alone[0] == pytest.approx(alone[1]), "with one cut the law knows no offset"


def test_a_joint_farther_from_where_its_limb_bends_is_worse_and_the_offset_stands_for_a_hinge_that_is_not_known() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01), "offset": np.full(3, 0.008)}
    found = error_bars(features(hinge=np.array([0.008, 0.032, np.nan]), **same), 4, SETTINGS).expected
    assert found[1] == pytest.approx(4.0**0.3 * found[0])
    assert found[2] == pytest.approx(found[0])
    without = {**same, "offset": np.full(3, np.nan)}
    far, near = (error_bars(features(hinge=np.full(3, hinge), **without), 4, SETTINGS).expected for hinge in (0.03, 0.003))
    assert far == pytest.approx(near), "without any offset the law knows no hinge"


def test_a_joint_in_softer_skin_is_worse_and_one_with_a_joint_below_that_turns_is_better() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01), "offset": np.full(3, 0.01)}
    for settings in (SETTINGS, ErrorBarsSettings()):
        soft = error_bars(features(softness=np.array([0.02, 0.1, 0.3]), **same), 4, settings).expected
        assert soft[0] < soft[1] < soft[2]
        below = error_bars(features(below=np.array([60.0, 10.0, 0.0]), **same), 4, settings).expected
        assert below[0] < below[1] < below[2]
        assert np.isfinite(error_bars(features(softness=np.zeros(3), **same), 4, settings).expected).all()


def test_a_joint_off_the_axes_of_its_parts_is_worse_and_one_without_parts_is_worst() -> None:
    same = {"spread": np.full(3, 0.004), "drift": np.full(3, 0.01), "offset": np.full(3, 0.01)}
    for settings in (SETTINGS, ErrorBarsSettings()):
        expected = error_bars(features(resistance=np.array([0.001, 0.1, np.nan]), **same), 4, settings).expected
        assert 1.3 * expected[0] < expected[1] < expected[2]
    free = error_bars(features(resistance=np.array([0.0, 1e-6, 1e-4]), **same), 4, SETTINGS).expected
    assert free == pytest.approx(free[2])
    without = error_bars(features(resistance=np.array([0.001, 0.1, np.nan]), **{**same, "offset": np.full(3, np.nan)}), 4)
    assert without.expected == pytest.approx(without.expected[0])


def test_the_error_is_larger_in_frames_without_confidence_and_its_mean_is_that_of_the_joint() -> None:
    confidence = np.ones((5, 3))
    confidence[1, 0] = 0.0
    found = error_bars(features(confidence=confidence), 4, SETTINGS)
    assert found.in_frame[1, 0] == pytest.approx(3.0 * found.in_frame[0, 0])
    assert found.expected == pytest.approx(found.in_frame.mean(axis=0))


def test_evidence_of_nothing_at_all_is_a_small_finite_error() -> None:
    nothing = np.zeros(3)
    found = error_bars(features(drift=nothing, spread=nothing, residual=nothing), 4, SETTINGS).expected
    assert (found > 0).all()
    assert (found < error_bars(features(), 4, SETTINGS).expected).all()


def test_a_hinge_whose_vertices_are_given_may_be_off_along_its_line_by_a_share_of_its_radius() -> None:
    nothing, radius = np.zeros(3), np.array([0.04, 0.08, np.nan])
    still = {"drift": nothing, "spread": nothing, "residual": nothing}
    least = SETTINGS._replace(several_cuts=SETTINGS.several_cuts._replace(least=0.02))
    found = error_bars(features(radius=radius, **still), 4, least).expected
    assert found == pytest.approx([0.004, 0.008, 0.02], rel=0.01)
    drifting, without = (error_bars(features(radius=r), 4, SETTINGS).expected for r in (radius, np.full(3, np.nan)))
    assert drifting[:2] == pytest.approx(np.hypot(0.1 * radius[:2], without[:2]))
    assert drifting[2] == without[2]
    assert error_bars(features(radius=radius), 1, SETTINGS).expected[0] == error_bars(features(), 1, SETTINGS).expected[0]


def test_no_error_is_below_the_least() -> None:
    nothing = np.zeros(3)
    least = SETTINGS._replace(several_cuts=SETTINGS.several_cuts._replace(least=0.004))
    found = error_bars(features(drift=nothing, spread=nothing, residual=nothing), 4, least).expected
    assert found == pytest.approx(0.004, rel=0.1)
    assert error_bars(features(), 4, least).expected == pytest.approx(
        np.hypot(0.004, error_bars(features(), 4, SETTINGS).expected)
    )


@pytest.mark.parametrize(("field", "share"), [("tube", 0.3), ("narrowing", 0.45), ("mirrored", 0.7)])
def test_a_joint_that_no_motion_shows_is_off_by_a_share_of_its_radius_whatever_the_motion_says(
    field: str, share: float
) -> None:
    radius = np.array([np.nan, 0.05, np.nan])
    bars, plain = error_bars(features(**{field: radius}), 4, SETTINGS), error_bars(features(), 4, SETTINGS)
    assert bars.expected[1] == pytest.approx(share * 0.05)
    assert bars.bound[1] == pytest.approx(2.0 * bars.expected[1])
    np.testing.assert_array_equal(bars.expected[[0, 2]], plain.expected[[0, 2]])


@pytest.mark.parametrize("offset", [np.nan, 0.002])
def test_a_joint_that_surfaces_show_is_better_than_its_missing_cuts_say(offset: float) -> None:
    """Of one cut no joint is in others."""
    known = {"offset": np.full(3, offset), "spread": np.full(3, np.nan)}
    shown = features(is_end_joint=np.array([False, True, False]), **known)
    for cuts, share in ((4, 0.25), (1, 1.0)):
        bars, plain = error_bars(shown, cuts, SETTINGS), error_bars(features(**known), cuts, SETTINGS)
        np.testing.assert_allclose(bars.expected, plain.expected * [1.0, share, 1.0])
        np.testing.assert_allclose(bars.bound, plain.bound * [1.0, share, 1.0])


def test_a_joint_whose_bone_is_not_as_long_as_its_mirror_image_is_worse_than_one_whose_bone_is() -> None:
    """Each by a power of the difference; one without a mirror image stays, and one cut knows too little to tell."""
    known, unlike = {"drift": np.full(3, 0.01), "spread": np.full(3, 0.004)}, np.array([np.nan, 0.008, 0.032])
    plain, told = error_bars(features(**known), 4, SETTINGS), error_bars(features(**known, asymmetry=unlike), 4, SETTINGS)
    expected = plain.expected ** [1.0, 0.8, 0.8] * [1.0, 0.008**0.2, 0.032**0.2]
    np.testing.assert_allclose(told.expected, expected)
    np.testing.assert_allclose(told.bound, 2.0 * expected)
    one = error_bars(features(**known, asymmetry=unlike), 1, SETTINGS)
    np.testing.assert_array_equal(one.expected, error_bars(features(**known), 1, SETTINGS).expected)


def test_bones_of_equal_length_leave_the_least_error() -> None:
    settings = SETTINGS._replace(several_cuts=SETTINGS.several_cuts._replace(least=0.002))
    same, least = (error_bars(features(asymmetry=np.full(3, u)), 4, settings).expected for u in (0.0, 0.002))
    np.testing.assert_array_equal(same, least)
    assert (same > 0.0).all()


def test_a_power_law_is_found_again_and_no_exponent_has_the_wrong_sign() -> None:
    rng = np.random.default_rng(0)
    drift, spread, residual, length, offset, resistance, hinge = np.exp(rng.normal(-5.0, 1.0, (7, 200)))
    below, softness = rng.uniform(1.0, 90.0, 200), rng.uniform(0.02, 0.4, 200)
    resistance = np.maximum(resistance, 1e-4)
    degrees, sure = rng.uniform(5, 120, 200), np.ones((1, 200))
    known = (drift, spread, residual, degrees, length, offset, resistance, hinge, below, softness)
    rows = JointFeatures(*known, drift, drift > 0.0, drift, drift, drift, drift, sure, 1.0).logarithms(True)
    law = [5.5, 0.4, 0.5, 0.1, -0.6, -0.2, 0.3, 0.2, 0.2, -0.1, 0.3]
    assert fitted(rows, np.exp(rows @ law)) == pytest.approx(law)
    for wrong, value in ((3, -0.3), (4, 0.6), (6, -0.3), (7, -0.3), (8, -0.3), (9, 0.3), (10, -0.3)):
        other = [value if k == wrong else exponent for k, exponent in enumerate(law)]
        assert fitted(rows, np.exp(rows @ other))[wrong] == 0.0


def test_one_cut_knows_no_joint_exactly_though_nothing_drifts() -> None:
    exact = features(drift=np.zeros(3), residual=np.zeros(3))
    assert (error_bars(exact, 1).expected > 0.002 * exact.size).all()
