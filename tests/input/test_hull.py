"""The hull of a frame from files: which views it was carved with, and what is said when some do not fit."""

import numpy as np
import pytest
from ball_views import rewrite, write_folder
from PIL import Image

from kinetree.errors import HullError, SourceError
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.hull import HullParams
from kinetree.schemas.input.source import SourceParams
from kinetree.tasks.input.hull import hull
from kinetree.tasks.input.source import source
from kinetree.tasks.views.input import hull_remarks

COARSE = {"resolution": 24}


@pytest.fixture
def walk(tmp_path):
    return write_folder(tmp_path / "walk")


@pytest.fixture
def frame(walk, tmp_path):
    """A frame of the folder as it is now."""
    return lambda t=1: source(SourceParams(input=str(walk)), Files.of(Store.at(tmp_path / "store")))[t]


def test_hull_is_carved_with_all_views(frame):
    carved = hull(frame(), HullParams(**COARSE))
    assert (carved.views, carved.missing, carved.cut) == (15, (), ())
    assert (carved.values > 0).any()
    assert hull_remarks(carved) == ()


def test_missing_and_empty_masks_are_named_and_may_be_left_out(walk, frame):
    (walk / "cam_03" / "frame_0001.png").unlink()
    Image.new("L", (200, 160)).save(walk / "cam_08" / "frame_0001.png")
    words = "walk, frame 1: no mask, or an empty one, of camera cam_03, cam_08: 13 of 15 views, 15 .* set hull.least_views=13"
    with pytest.raises(HullError, match=words):
        hull(frame(), HullParams(**COARSE))
    carved = hull(frame(), HullParams(least_views=13, **COARSE))
    assert (carved.views, carved.missing) == (13, ("cam_03", "cam_08"))
    assert "without camera cam_03, cam_08" in hull_remarks(carved)[0]
    assert hull(frame(0), HullParams(**COARSE)).views == 15


def test_views_that_cut_the_body_are_named(walk, frame):
    path = walk / "cam_05" / "frame_0001.png"
    image = np.asarray(Image.open(path)).copy()
    image[:, :100] = 255 * (image[:, 100:101] > 0)
    Image.fromarray(image).save(path)
    carved = hull(frame(), HullParams(**COARSE))
    assert carved.cut == ("cam_05",)
    assert "cuts the body in 1 of 15 views (cam_05)" in hull_remarks(carved)[0]


def test_calibration_that_does_not_fit_is_said_with_frame_and_camera(walk, frame):
    document = np.array([[60.0, 0, 99.5, 0], [0, 60, 79.5, 0], [0, 0, 1, 500]])
    rewrite(walk, P=document.tolist())
    with pytest.raises(HullError, match=r"walk, frame 1: the rectangles of the 15 .* no common point; .* camera cam_00"):
        hull(frame(), HullParams(**COARSE))


def test_files_that_changed_since_the_plan_are_refused(walk, frame):
    planned = frame()
    path = walk / "cam_05" / "frame_0001.png"
    path.write_bytes((walk / "cam_05" / "frame_0002.png").read_bytes())
    with pytest.raises(SourceError, match="walk, frame 1: the file changed while the run was under way"):
        hull(planned, HullParams(**COARSE))
