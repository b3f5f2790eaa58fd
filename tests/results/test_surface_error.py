"""The skinned mesh of a skeleton against the frames it was made from."""

import numpy as np
import pytest
from results.rigged_bodies import spider
from results.sample_report import artifacts

from kinetree.tasks.results.surface_error import surface_error


def test_every_frame_is_compared_with_its_own_pose():
    meshes = artifacts()["mesh"]
    for frame in (0, 7):
        error = surface_error(skeleton=spider(), mesh=meshes[frame], index=(frame,))
        assert error.distance.dtype == np.float32
        assert error.distance.max() == pytest.approx(0.0, abs=1e-5)
    other = surface_error(skeleton=spider(), mesh=meshes[0], index=(7,))
    assert other.skin.max() > 0.5
