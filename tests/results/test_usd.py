"""skeleton.usda, judged and evaluated by Pixar's own library."""

import numpy as np
import pytest
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.errors import ConfigError
from kinetree.pipeline import views
from kinetree.schemas.results.usd import UsdParams
from kinetree.schemas.topology.up_direction import UpDirection
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.results.formats import usd as exports
from kinetree.tasks.results.usd import usd

needs_usd = pytest.mark.skipif(
    not __import__("importlib.util").util.find_spec("pxr"), reason="pip install 'kinetree[usd]' brings Pixar's library"
)


Y_UP = UpDirection(up="y", confidence=0.9)


def written(skeleton, found=Y_UP, **params):
    return views.files(usd(skeleton, plain(skeleton), found, UsdParams(**params)), ())["skeleton.usda"]


@pytest.fixture
def opened(tmp_path):
    """Opens what was written; a stage lives as long as somebody keeps it, and a path is read once."""
    stages = []

    def open_(skeleton, found=Y_UP, **params):
        from pxr import Usd

        path = tmp_path / f"skeleton_{len(stages)}.usda"
        path.write_bytes(written(skeleton, found, **params))
        stages.append(Usd.Stage.Open(str(path)))
        return stages[-1]

    return open_


def queries(stage):
    from pxr import Usd, UsdSkel

    root, cache = UsdSkel.Root(stage.GetDefaultPrim()), UsdSkel.Cache()
    cache.Populate(root, Usd.PrimDefaultPredicate)
    (binding,) = cache.ComputeSkelBindings(root, Usd.PrimDefaultPredicate)
    return cache.GetSkelQuery(binding.GetSkeleton()), binding.GetSkinningTargets()[0]


@needs_usd
def test_every_validator_that_usdchecker_runs_is_content(opened):
    from pxr import UsdValidation

    validators = UsdValidation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) >= 10
    for skeleton in (spider(), spider(names=tuple("<&> \n'é"), fps=None, unit=None)):
        results = UsdValidation.ValidationContext(validators).Validate(opened(skeleton, up="z"))
        assert [(e.GetName(), e.GetMessage()) for e in results] == []


@needs_usd
def test_joints_are_where_the_skeleton_has_them_in_every_frame(opened):
    from pxr import UsdGeom

    body = spider()
    skeleton, _ = queries(opened(body))
    for t, frame in enumerate(body.frames):
        at = UsdGeom.XformCache(frame)
        results = np.array(skeleton.ComputeJointWorldTransforms(at))[:, 3, :3]
        np.testing.assert_allclose(results, body.positions[t] / 1000, atol=1e-7)


@needs_usd
def test_skin_moves_as_the_skeleton_says_in_every_frame(opened):
    from pxr import UsdGeom, Vt

    body = spider()
    stage = opened(body)
    skeleton, skin = queries(stage)
    mesh = UsdGeom.Mesh.Get(stage, "/body/mesh")
    truth = skinned(body)
    for t, frame in enumerate(body.frames):
        points = Vt.Vec3fArray(mesh.GetPointsAttr().Get())
        assert skin.ComputeSkinnedPoints(skeleton.ComputeSkinningTransforms(frame), points, frame)
        np.testing.assert_allclose(np.array(points), truth[t] / 1000, atol=1e-7)


@needs_usd
def test_usd_is_a_sequence_to_begin_with(tmp_path):
    """What is exported goes in again, surface and motion the same."""
    body = spider()
    (tmp_path / "skeleton.usda").write_bytes(written(body))
    frames, truth = read_animated(tmp_path / "skeleton.usda"), skinned(body) / 1000
    size = np.linalg.norm(np.ptp(body.vertices, axis=0)) / 1000
    assert (len(frames), frames.fps) == (len(body.frames), body.fps)
    for t in range(len(frames)):
        X, F = frames.mesh(t)
        assert np.abs(X - truth[t]).max() < 2e-6 * size
        np.testing.assert_array_equal(F, body.faces)


@needs_usd
def test_stage_tells_pace_unit_and_up(opened):
    from pxr import UsdGeom

    stage = opened(spider(frames=(3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 20)), up="z")
    assert (stage.GetStartTimeCode(), stage.GetEndTimeCode(), stage.GetTimeCodesPerSecond()) == (3, 20, 10)
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1
    assert UsdGeom.GetStageUpAxis(stage) == "Z"
    assert UsdGeom.GetStageUpAxis(opened(spider(), UpDirection(up="z", confidence=0.9))) == "Z"
    assert opened(spider(fps=None)).GetTimeCodesPerSecond() == 30


@needs_usd
def test_axis_that_usd_does_not_know_is_turned_to_y(opened):
    from pxr import UsdGeom

    body = spider(unit=None)
    stage = opened(body, UpDirection(up="-x", confidence=0.9))
    assert UsdGeom.GetStageUpAxis(stage) == "Y"
    results = np.array(queries(stage)[0].ComputeJointWorldTransforms(UsdGeom.XformCache(3)))[:, 3, :3]
    np.testing.assert_allclose(results[:, 1], -body.positions[3][:, 0] / 100, atol=1e-6)


@needs_usd
def test_box_holds_the_skin_in_every_frame(opened):
    from pxr import UsdSkel

    low, high = np.array(UsdSkel.Root(opened(spider()).GetDefaultPrim()).GetExtentAttr().Get())
    X = skinned(spider()) / 1000
    assert np.all(np.minimum(X - low, high - X) >= 0)


@needs_usd
def test_names_are_kept_beside_the_paths_and_bytes_are_the_same_every_time(opened):
    from pxr import UsdSkel

    names = ("a b", "<script>", "línea\n2", "關節", '"', "\\", "c")
    skeleton = UsdSkel.Skeleton.Get(opened(spider(names=names)), "/body/skeleton")
    assert tuple(skeleton.GetJointNamesAttr().Get()) == names
    assert len(set(skeleton.GetJointsAttr().Get())) == 7
    assert written(spider()) == written(spider())


def test_missing_package_says_which_extra_brings_it(monkeypatch):
    def absent(name):
        raise ImportError(name)

    exports._pxr.cache_clear()
    monkeypatch.setattr(exports, "import_module", absent)
    with pytest.raises(ConfigError, match=r"pip install 'kinetree\[usd\]'"):
        written(spider())
