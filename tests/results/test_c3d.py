"""skeleton.c3d, read back by two libraries, of which one has nothing to do with the one that wrote it."""

import io
import warnings

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.errors import ConfigError
from kinetree.pipeline import views
from kinetree.schemas.results.c3d import C3dParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.results.c3d import c3d
from kinetree.tasks.results.formats import c3d as format_of_c3d

Z_UP = UpDirection(up="z", confidence=0.9)


def written(skeleton, **params):
    return views.files(c3d(skeleton, plain(skeleton), Z_UP, C3dParams(**params)), ())["skeleton.c3d"]


def test_ezc3d_reads_every_joint_as_a_marker_upright_along_z_in_millimetres(tmp_path):
    ezc3d = pytest.importorskip("ezc3d", reason="pip install 'kinetree[c3d]' brings the library")
    body = spider(unit="cm")
    (tmp_path / "skeleton.c3d").write_bytes(written(body))
    file = ezc3d.c3d(str(tmp_path / "skeleton.c3d"))
    point = file["parameters"]["POINT"]
    assert [name.strip() for name in point["LABELS"]["value"]] == list(body.names)
    assert (point["UNITS"]["value"], point["RATE"]["value"][0]) == (["mm"], 10.0)
    assert (point["X_SCREEN"]["value"], point["Y_SCREEN"]["value"]) == (["+X"], ["+Z"])
    np.testing.assert_allclose(file["data"]["points"][:3].T, 10 * body.positions.transpose(0, 1, 2), rtol=1e-6, atol=1e-4)


def test_another_library_reads_the_same_and_knows_which_frames_are_missing():
    pytest.importorskip("ezc3d", reason="pip install 'kinetree[c3d]' brings the library")
    library = pytest.importorskip("c3d", reason="pip install c3d brings the reader")
    body = spider(frames=(0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 26))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # there are no analogue channels
        reader = library.Reader(io.BytesIO(written(body, up="y")))
        frames = np.stack([points for _, points, _ in reader.read_frames()])
    assert reader.point_rate == 5.0
    assert (frames[11:13, :, 3] == -1).all()
    there = [*range(11), 13]
    assert (frames[there, :, 3] == 0).all()
    expected = body.positions[..., [0, 2, 1]] * [1, 1, -1]
    np.testing.assert_allclose(frames[there, :, :3], expected, rtol=1e-5, atol=1e-4)


def test_same_skeleton_gives_the_same_bytes():
    pytest.importorskip("ezc3d", reason="pip install 'kinetree[c3d]' brings the library")
    assert written(spider()) == written(spider())


def test_missing_package_says_which_extra_brings_it(monkeypatch):
    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr(format_of_c3d, "import_module", absent)
    with pytest.raises(ConfigError, match=r"pip install 'kinetree\[c3d\]'"):
        written(spider())
