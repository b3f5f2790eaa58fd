"""The moving body as the page contains it."""

import zlib

from results.sample_report import page_artifacts

from kinetree.schemas.results.excerpt import ExcerptParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.results.page.played_scene import played_scene


def test_page_reads_what_was_packed() -> None:
    packed = page_artifacts(ExcerptParams(frames=4, views=1))["played_body"]
    scene = played_scene(packed)
    assert scene.description["frames"] == [0, 4, 7, 11]
    arrays = scene.description["arrays"]
    raw = zlib.decompress(scene.block)
    last = max(arrays.values(), key=lambda array: array["offset"])
    assert len(raw) > last["offset"]
    assert scene.omitted == packed.omitted


def test_it_waits_for_no_picture_and_no_error() -> None:
    graph = METHODS["mesoscopic"]
    needed = graph.until(["played_body"]).by_name
    assert not {"structure_figures", "motion_figures", "skeleton_figures"} & set(needed)
    assert not {"evaluation", "surface_error", "verdict", "error_bars"} & set(needed)
