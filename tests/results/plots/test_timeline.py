"""Time and names on axes."""

import numpy as np
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.errors import UnknownNodeError
from kinetree.schemas.structure.joint_names import JointNames
from kinetree.tasks.results.plots.drawing import blank
from kinetree.tasks.results.plots.motion import angles, columns_of, panels, signed_angles
from kinetree.tasks.results.plots.timeline import joint_labels, over_time

FRAMES = (10, 11, 12, 20)


def test_seconds_since_the_first_frame_stand_where_the_frame_is() -> None:
    _, axes = blank(4.0, 2.0)
    over_time(axes, FRAMES, 10.0)
    assert axes.get_xlabel() == "time, s"
    for place, label in zip(axes.get_xticks(), axes.get_xticklabels(), strict=True):
        assert (place - 10) / 10.0 == float(label.get_text())


def test_frames_stand_there_where_no_rate_is_known() -> None:
    _, axes = blank(4.0, 2.0)
    over_time(axes, FRAMES, None)
    assert axes.get_xlabel() == "frame"


def named() -> JointNames:
    body = spider()
    anatomy = ["", "", "", "", "", "", ""]
    anatomy[body.names.index("arm")], anatomy[body.names.index("knee")] = "shoulder_l", "shoulder_r"
    return plain(body, anatomy=tuple(anatomy), front=np.array([0.0, 0.0, 1.0]), front_confidence=1.0)


def test_joints_are_called_as_people_call_them_and_else_as_the_skeleton_does() -> None:
    body = spider()
    labels = joint_labels(lambda _: named(), body.names)
    assert (labels[body.names.index("arm")], labels[0]) == ("left shoulder", body.names[0])

    def nothing(name: str) -> JointNames:
        raise UnknownNodeError(name)

    assert joint_labels(nothing, body.names) == body.names


def test_left_and_right_of_a_place_are_in_one_picture_and_every_joint_is_in_one() -> None:
    body = spider()
    (panel,) = panels(body, named(), signed_angles(body, named()))
    assert (panel.name, list(panel.joints)) == ("shoulder", ["left", "right"])
    apart = panels(body, plain(body), signed_angles(body, plain(body)))
    assert [p.name for p in apart] == ["arm", "knee"]
    assert not any(p.is_signed for p in apart)


def test_no_picture_of_the_angles_is_empty_and_all_have_one_scale() -> None:
    body = spider()
    figure = angles(lambda name: plain(body) if name == "joint_names" else body, [])
    assert len(figure.axes) == 2
    assert all(axes.lines for axes in figure.axes)
    assert len({axes.get_ylim() for axes in figure.axes}) == 1


def test_grid_of_small_pictures_has_few_empty_places_and_is_not_narrow() -> None:
    assert [columns_of(n) for n in (1, 2, 3, 4, 6, 8, 9, 12, 14)] == [1, 2, 3, 4, 3, 4, 3, 4, 3]
