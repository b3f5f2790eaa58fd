"""Contract of reference: a frame free of contact, or the one that is named, and words where there is no good one."""

import numpy as np
import pytest

from kinetree.errors import SourceError
from kinetree.pipeline import views
from kinetree.schemas.input.connectivity import Connectivity
from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.reference import Reference, ReferenceParams
from kinetree.schemas.topology.extrema import Extrema
from kinetree.schemas.topology.leaves import Leaves
from kinetree.schemas.topology.mu_histogram import MuHistogram
from kinetree.tasks.registration.reference import reference

V = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=float)
F = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]], dtype=np.int32)


def tips_of(leaves: int, bent: float = 0.0, loop: float = 0.0, euler: int = 2) -> Extrema:
    stem = np.array([[0, 0, 0], [0, 0, 1], [np.sin(bent), 0, 1 + np.cos(bent)]])
    return Extrema(
        vertices=np.zeros(leaves, int), persistence=np.full(leaves, 0.5), stems=np.tile(stem, (leaves, 1, 1)),
        normals=np.zeros((leaves, 3)), value=np.full(leaves, 0.7), peaks=np.full(leaves, 0.5), loops=np.array([loop]), size=1.0,
        centre=(0.0, 0.0, 0.0), euler=euler, components=1,
    )  # fmt: skip


def followed(leaves: list[int]) -> Leaves:
    rows = np.array([[k if k < n else -1 for n in leaves] for k in range(max(leaves))], int).reshape(-1, len(leaves))
    none = np.zeros(0, int)
    return Leaves(
        frames=tuple(range(len(leaves))), rows=rows, positions=np.zeros((*rows.shape, 3)), kept=rows[:, :1].T >= 0,
        lost=none, lost_begin=none, lost_end=none,
    )  # fmt: skip


def same() -> MuHistogram:
    fine = np.exp(-(((np.linspace(0, 1, 500) - 0.5) / 0.1) ** 2))
    return MuHistogram(normalisation="sequence", low=0.5, high=1.5, mass=fine / fine.sum())


def chosen(
    leaves: list[int],
    *,
    fixed: bool = False,
    bent: list[float] | None = None,
    loop: float = 0.0,
    first: int = 0,
    frame: int | None = None,
) -> Reference:
    frames = range(first, first + len(leaves))
    angles = bent or [0.5] * len(leaves)
    cleaning = Cleaning(area=4.0)
    return reference(
        mesh={t: Mesh(vertices=V + t, faces=F, vertex_of_input=np.arange(4), cleaning=cleaning) for t in frames},
        distribution={t: same() for t in frames},
        tips={t: tips_of(n, a, loop) for t, n, a in zip(frames, leaves, angles, strict=True)},
        leaves=followed(leaves),
        connectivity=Connectivity(fixed=fixed, first_change=None if fixed else first + 1, vertices=4, faces=4),
        params=ReferenceParams(frame=frame),
    )


def test_frame_far_from_every_contact_is_the_reference() -> None:
    told = chosen([4, 4, 4, 5, 5, 5, 5, 5, 4, 4], first=10)
    assert (told.frame, told.free, told.leaves) == (15, True, 5)
    assert np.array_equal(told.vertices, V + 15)
    assert told.size == pytest.approx(2.0)
    assert views.remarks(told) == ("reference: frame 15",)


def test_pose_amid_the_others_goes_before_a_remote_one() -> None:
    assert chosen([5] * 5, bent=[0.5, 0.5, 1.5, 0.5, 0.5]).frame in (1, 3)


def test_a_frame_that_is_named_is_the_reference_whatever_its_score() -> None:
    leaves = [4, 4, 4, 5, 5, 5, 5, 5, 4, 4]
    told = chosen(leaves, first=10, frame=11)
    assert (told.frame, told.free, told.leaves) == (11, False, 5)
    assert np.array_equal(told.vertices, V + 11)
    assert np.array_equal(told.score, chosen(leaves, first=10).score)


def test_a_frame_that_nothing_is_learned_from_cannot_be_the_reference() -> None:
    with pytest.raises(SourceError, match=r"reference\.frame: frame 9 is none of the 4 frames .* which are 10 to 13"):
        chosen([5] * 4, first=10, frame=9)


def test_contact_in_every_frame_gives_the_least_bad_one_and_says_so() -> None:
    told = chosen([4, 5, 4, 5, 4, 5])
    assert not told.free
    assert any("no contact-free frame; frame" in text for text in views.remarks(told))


def test_a_loop_in_the_reference_is_told_since_what_touches_there_stays_joined() -> None:
    assert any("has a loop" in text for text in views.remarks(chosen([5] * 5, loop=0.2)))
    assert not any("has a loop" in text for text in views.remarks(chosen([5] * 5, loop=0.05)))


@pytest.mark.parametrize(("leaves", "words"), [(0, "no limb"), (1, "only one limb"), (2, "only two limbs")])
def test_fewer_than_three_limbs_are_enough_and_the_run_says_so(leaves: int, words: str) -> None:
    told = chosen([leaves] * 3)
    assert told.frame == 1
    assert any(text.startswith(f"{words} found in any frame") for text in views.remarks(told))


def test_one_or_two_frames_have_a_reference() -> None:
    assert chosen([5]).frame == 0
    two = chosen([5, 5])
    assert any(text.startswith("only two frames; joints that do not turn between them") for text in views.remarks(two))


def test_fixed_connectivity_is_passed_on() -> None:
    assert chosen([5, 5, 5], fixed=True).fixed
    assert not chosen([5, 5, 5]).fixed
