"""Names of joints."""

import numpy as np
import pytest

from kinetree.tasks.numerics.structure.joint_names import joint_names, widest_gaps

# pelvis; two legs; spine; head; two arms
JOINTS = {
    "pelvis": (None, (0, 0, 0)), "knee_l": ("hip_l", (1, 0, -5)), "hip_l": ("pelvis", (1, 0, -1)),
    "foot_l": ("knee_l", (1, 1, -9)), "hip_r": ("pelvis", (-1, 0, -1)), "knee_r": ("hip_r", (-1, 0, -5)),
    "foot_r": ("knee_r", (-1, 1, -9)), "chest": ("pelvis", (0, 0, 3)), "neck": ("chest", (0, 0, 6)),
    "crown": ("neck", (0, 0, 8)), "arm_l": ("chest", (2, 0, 5)), "hand_l": ("arm_l", (5, 0, 5)),
    "arm_r": ("chest", (-2, 0, 5)), "hand_r": ("arm_r", (-5, 0, 5)),
}  # fmt: skip
ENDS = {"foot_l", "foot_r", "crown", "hand_l", "hand_r"}


def names_of(order: list[str], wobble: float = 0.0) -> dict[str, str]:
    """Joint → name, the joints given in some order in which parents come first."""
    rest = np.array([JOINTS[k][1] for k in order], float)
    rest += wobble * np.random.default_rng(3).normal(size=rest.shape)
    parents = np.array([-1 if JOINTS[k][0] is None else order.index(str(JOINTS[k][0])) for k in order])
    found = joint_names(rest, parents, np.array([k in ENDS for k in order]))
    assert len(set(found.names)) == len(order)
    place = {j: n for n, j in enumerate(found.order.tolist())}
    assert all(place[int(parents[j])] < place[j] for j in range(1, len(order)))
    return {order[j]: name for j, name in zip(found.order, found.names, strict=True)}


def shuffled(seed: int) -> list[str]:
    rng, order = np.random.default_rng(seed), ["pelvis"]
    while len(order) < len(JOINTS):
        ready = sorted(k for k, (p, _) in JOINTS.items() if k not in order and p in order)
        order.append(str(rng.choice(ready)))
    return order


def test_names_tell_the_tree() -> None:
    names = names_of(shuffled(0))
    assert names["pelvis"] == "root"
    assert names["chest"] == "spine_1"
    assert (names["hip_l"], names["knee_l"], names["foot_l"]) in {
        ("limb_d_1", "limb_d_2", "limb_d_end"),
        ("limb_e_1", "limb_e_2", "limb_e_end"),
    }
    assert {names[k] for k in ("neck", "arm_l", "arm_r")} == {"limb_a_1", "limb_b_1", "limb_c_1"}


@pytest.mark.parametrize("seed", range(8))
def test_names_do_not_depend_on_the_order_in_which_joints_are_given(seed: int) -> None:
    assert names_of(shuffled(seed)) == names_of(shuffled(99))


def test_names_stay_under_small_changes() -> None:
    assert names_of(shuffled(0), wobble=0.05) == names_of(shuffled(0))


def test_ends_beside_joints_are_told_apart() -> None:
    rest = np.array([[0, 0, 0], [0, 0, 1], [0, 0, 3], [1, 0, 2], [0, 1, 2.0]])
    found = joint_names(rest, np.array([-1, 0, 1, 1, 0]), np.array([False, False, True, True, True]))
    assert found.names == ("root", "limb_a_1", "limb_a_end_1", "limb_a_end_2", "root_end")


def test_root_alone_is_the_root() -> None:
    assert joint_names(np.zeros((1, 3)), np.array([-1]), np.array([False])).names == ("root",)


def test_the_widest_gap_decides_first() -> None:
    assert widest_gaps(np.array([[1.0, 0.0], [1.1, 9.0], [5.0, 4.0]])) == [1, 2, 0]
    assert widest_gaps(np.zeros((0, 2))) == []


def test_there_are_letters_for_any_number_of_limbs() -> None:
    angle = np.linspace(0, 6, 30)
    rest = np.concatenate([np.zeros((1, 3)), np.stack([np.cos(angle), np.sin(angle), 0.01 * np.arange(30)], axis=1)])
    found = joint_names(rest, np.array([-1] + [0] * 30), np.zeros(31, bool))
    assert found.names[1] == "limb_a_1"
    assert found.names[-1] == "limb_ad_1"
