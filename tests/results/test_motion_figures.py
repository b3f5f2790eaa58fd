"""The picture of angles names the joints."""

from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.tasks.results.motion_figures import motion_figures


def test_the_picture_names_the_joints() -> None:
    body = spider()
    (file,) = motion_figures(body, plain(body)).files()
    for name in (name for name, kind in zip(body.names, body.kinds, strict=True) if kind == "joint"):
        assert name.encode() in file, name
