"""Laws of the examination: what stands out in a walk of a box is named; poses, debris, seams and travel are not."""

import numpy as np
import pytest
import trimesh

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.bad_frames import (
    FrameMeasures,
    bad_frames,
    frame_measures,
    frames_of_other_bodies,
    refuse_bad,
    refuse_other_bodies,
)

BOX = trimesh.creation.box((1, 2, 5)).subdivide().subdivide()
V, F = np.array(BOX.vertices), np.array(BOX.faces)


def walk(step=0.3, **changed):
    """Measures of twelve frames of a box that walks; frame 5 with the vertices or faces that are given."""
    frames = {t: (V + [step * t, 0, 0], F) for t in range(12)}
    frames[5] = (changed.get("vertices", frames[5][0]), changed.get("faces", F))
    return {t: frame_measures(*frame) for t, frame in frames.items()}


def test_measures_of_a_box():
    m = frame_measures(V, F)
    assert m.area == pytest.approx(2 * (2 + 5 + 10))
    assert m.centre == pytest.approx((0, 0, 0), abs=0.5)
    assert 0.8 * np.sqrt(30) < m.size <= np.sqrt(30) + 1e-9
    assert (m.vertices, m.pieces) == (len(V), 1)
    assert m.volume == pytest.approx(10)


def test_volume_of_an_open_surface_is_not_known():
    assert frame_measures(V, F[BOX.triangles_center[:, 2] < 2.4]).volume == 0  # a box without its lid
    assert frame_measures(V, F[1:]).volume == pytest.approx(10, rel=0.02)  # a small hole
    assert frame_measures(V + 1e4, F[:, ::-1]).volume == pytest.approx(10)


@pytest.mark.parametrize("step", [0.0, 0.3, 40.0])
def test_frames_of_one_body_are_good_however_far_it_goes(step):
    assert bad_frames(walk(step)) == {}
    bent = V * [1, 1, 0.5] + [5 * step, 0, 0]
    assert bad_frames(walk(step, vertices=bent)) == {}


@pytest.mark.parametrize("scale", [0.001, 0.1, 2.54, 10.0, 1e4])
def test_frame_in_another_unit_is_named(scale):
    (reason,) = bad_frames(walk(vertices=V * scale)).values()
    assert "in the median of all frames" in reason


def test_frame_that_lies_elsewhere_is_named():
    bad = bad_frames(walk(vertices=V + [0, 100, 0]))
    assert list(bad) == [5]
    assert "sizes of the body away from the frames around it" in bad[5]


def test_torn_surface_is_named():
    pieces = trimesh.util.concatenate([trimesh.creation.box((1, 1, 1), transform=np.eye(4) + _shift(i)) for i in range(9)])
    bad = bad_frames(walk(vertices=np.array(pieces.vertices) * [1, 1, 0.25], faces=np.array(pieces.faces)))
    assert bad == {5: "its surface is torn into 9 large pieces, that of most frames has 1"}


def _shift(i):
    out = np.zeros((4, 4))
    out[2, 3] = 2 * i - 8
    return out


def test_debris_and_seams_do_not_make_a_frame_bad():
    speck = np.array([[1e4, 0, 0], [1e4, 0.1, 0], [1e4, 0, 0.1]])
    soup = np.concatenate([V[F].reshape(-1, 3), speck])
    measures = walk(vertices=soup, faces=np.arange(len(soup)).reshape(-1, 3))
    assert measures[5].pieces == 1
    assert bad_frames(measures) == {}


def test_frame_without_area_or_that_cannot_be_read_is_named():
    measures = walk(vertices=V * 0) | {7: "f7.ply: the file is empty"}
    assert bad_frames(measures) == {5: "its faces have no area; export the frame again", 7: "f7.ply: the file is empty"}


def test_two_frames_say_nothing_about_each_other():
    assert bad_frames({0: frame_measures(V, F), 1: frame_measures(V * 100, F)}) == {}


def test_share_decides_what_is_refused():
    bad = dict.fromkeys(range(4), "torn")
    refuse_bad(bad, 20, 0.2)
    refuse_bad({}, 20, None)
    with pytest.raises(SourceError, match=r"^4 of 19 frames cannot .*bad_share allows 0\.2\): frame 0: torn; .*1 more$"):
        refuse_bad(bad, 19, 0.2)
    with pytest.raises(SourceError, match=r"set source\.on_bad_frame=drop to go on without them"):
        refuse_bad(bad, 20, None)


def walk_on(*scales):
    """Measures of a box that walks, of these sizes by frame."""
    return {t: frame_measures(V * scale + [0.3 * t, 0, 0], F) for t, scale in enumerate(scales)}


def test_frames_from_which_on_a_larger_body_walks_are_named():
    assert frames_of_other_bodies(walk_on(*[1.0] * 16)) == {}
    bad = frames_of_other_bodies(walk_on(*[1.0] * 10, *[1.03] * 6))
    assert list(bad) == list(range(10, 16))
    (reason,) = set(bad.values())
    assert reason.startswith("frames 10 to 15 show another body: their volume is 10.93, that of the others 10; compute them by")
    with pytest.raises(
        SourceError, match=r"^6 of 16 frames cannot .*allows 0\.2\): frames 10 to 15 show another body: .*=keep$"
    ):
        refuse_bad(bad, 16, 0.2)


def test_a_take_whose_body_is_larger_is_refused_by_name():
    def take(area, volume=1.0):
        return [FrameMeasures(area * (1 + 0.01 * t), 2.0, (0.0, 0.0, 0.0), 500, 1, volume) for t in range(5)]

    refuse_other_bodies({"a": take(4.0), "b": take(4.3), "c": [], "d": take(3.6)})
    with pytest.raises(SourceError, match="take c is not of the same body as take a: .* is 8.16, not 4.08"):
        refuse_other_bodies({"a": take(4.0), "b": take(4.3), "c": take(8.0)})
    refuse_other_bodies({"a": take(4.0), "b": take(4.0, 1.2), "c": take(4.0, 0.0)})
    with pytest.raises(
        SourceError, match="take b is not of the same body as take a: the median volume of its frames is 1.4, not 1"
    ):
        refuse_other_bodies({"a": take(4.0), "b": take(4.0, 1.4)})
