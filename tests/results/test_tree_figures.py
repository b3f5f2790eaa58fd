"""Pictures of the joints name them all."""

from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.tasks.results.tree_figures import tree_figures


def test_every_picture_names_the_joints() -> None:
    body = spider()
    files = tree_figures(body, plain(body)).files()
    assert len(files) == 2
    for name in (name for name, kind in zip(body.names, body.kinds, strict=True) if kind == "joint"):
        assert all(name.encode() in file for file in files), name
