"""Laws of a USD stage over time; the skinned ones are proved by a round trip of our own export."""

import zipfile
from pathlib import Path

import numpy as np
import pytest

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input import animated_usd
from kinetree.tasks.numerics.input.animated import read_animated
from kinetree.tasks.numerics.input.animated_usd import AnimatedUsd

pytest.importorskip("pxr", reason="pip install 'kinetree[usd]' brings Pixar's library")
from pxr import Sdf, Usd, UsdGeom, UsdUtils

V = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
COUNTS, CORNERS = [4, 3, 3, 3, 3], [0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]


@pytest.fixture
def stage(tmp_path):
    """A pyramid whose top rises by 1 a frame while all of it moves along x."""
    created = Usd.Stage.CreateNew(str(tmp_path / "pyramid.usda"))
    created.SetStartTimeCode(1)
    created.SetEndTimeCode(4)
    created.SetTimeCodesPerSecond(50)
    UsdGeom.SetStageMetersPerUnit(created, 0.01)
    moved = UsdGeom.Xform.Define(created, "/moved").AddTranslateOp()
    mesh = UsdGeom.Mesh.Define(created, "/moved/pyramid")
    mesh.CreateFaceVertexCountsAttr(COUNTS)
    mesh.CreateFaceVertexIndicesAttr(CORNERS)
    for t in range(1, 5):
        moved.Set((t, 0, 0), t)
        mesh.CreatePointsAttr().Set([tuple(map(float, v)) for v in V + np.float32([0, 0, t]) * (V[:, 2:] > 0)], t)
    return created


def read(stage):
    stage.Save()
    frames = read_animated(Path(stage.GetRootLayer().realPath))
    assert isinstance(frames, AnimatedUsd)
    return frames


def test_points_and_places_over_time_are_the_frames(stage):
    frames = read(stage)
    assert (len(frames), frames.fps, frames.unit) == (4, 50.0, "cm")
    for t in range(4):
        X, F = frames.mesh(t)
        np.testing.assert_allclose(X, V + np.float32([0, 0, t + 1]) * (V[:, 2:] > 0) + [t + 1, 0, 0])
        assert len(F) == 6  # one quad is two triangles
        assert np.einsum("fi,fi->", X[F[:, 0]], np.cross(X[F[:, 1]], X[F[:, 2]])) > 0


def test_left_handed_faces_are_turned_and_hidden_meshes_are_left_out(stage):
    mesh = UsdGeom.Mesh.Get(stage, "/moved/pyramid")
    mesh.CreateOrientationAttr("leftHanded")
    hidden = UsdGeom.Mesh.Define(stage, "/hidden")
    hidden.CreatePointsAttr([(9, 9, 9)])
    hidden.CreateVisibilityAttr("invisible")
    X, F = read(stage).mesh(0)
    assert len(X) == len(V)
    assert np.einsum("fi,fi->", X[F[:, 0]], np.cross(X[F[:, 1]], X[F[:, 2]])) < 0


def test_other_units_are_brought_to_metres(stage):
    UsdGeom.SetStageMetersPerUnit(stage, 0.0254)
    frames = read(stage)
    assert frames.unit == "m"
    np.testing.assert_allclose(frames.mesh(0)[0][0], [0.0254, 0, 0])


@pytest.mark.parametrize("wrong", [0.0, -25.0, float("nan"), float("inf")])
def test_rates_and_units_that_are_none_are_refused(stage, wrong):
    stage.SetTimeCodesPerSecond(wrong)
    with pytest.raises(SourceError, match=r"time codes a second and units of 0\.01 m; both must be positive"):
        read(stage)
    stage.SetTimeCodesPerSecond(50)
    UsdGeom.SetStageMetersPerUnit(stage, wrong)
    with pytest.raises(SourceError, match="its stage has 50 time codes a second and units of .* both must be positive"):
        read(stage)


def test_stages_of_other_files_still_ones_and_damaged_ones_are_refused(stage, tmp_path):
    stage.GetRootLayer().subLayerPaths.append("/etc/passwd")
    with pytest.raises(SourceError, match=r"composed of other files \('/etc/passwd'\), which are not read; flatten it"):
        read(stage)
    stage.GetRootLayer().subLayerPaths.clear()
    stage.SetEndTimeCode(1)
    with pytest.raises(SourceError, match="its stage has 1 time codes; at least two"):
        read(stage)
    (tmp_path / "damaged.usdc").write_bytes(b"PXR-USDC" + b"\xff" * 80)
    with pytest.raises(SourceError, match=r"damaged\.usdc: cannot be read as USD"):
        read_animated(tmp_path / "damaged.usdc")


def test_stage_that_changed_on_disk_is_read_anew_also_as_a_package(stage, tmp_path):
    assert read(stage).mesh(0)[0][4, 2] == 2
    for suffix in (".usda", ".usdz"):
        mesh = UsdGeom.Mesh.Get(stage, "/moved/pyramid")
        height = 7.0 if suffix == ".usda" else 8.0
        mesh.GetPointsAttr().Set([tuple(map(float, v)) for v in V * np.float32([1, 1, height])], 1)
        stage.Save()
        path = tmp_path / f"pyramid{suffix}"
        if suffix == ".usdz":
            assert UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(tmp_path / "pyramid.usda")), str(path))
        assert read_animated(path).mesh(0)[0][4, 2] == height


def test_package_that_refers_outside_itself_is_refused(stage, tmp_path):
    stage.Save()
    inner = tmp_path / "inner.usda"
    inner.write_text(f"#usda 1.0\n(\n    subLayers = [@{tmp_path / 'pyramid.usda'}@]\n)\n")
    writer = Sdf.ZipFileWriter.CreateNew(str(tmp_path / "walk.usdz"))
    writer.AddFile(str(inner), "inner.usda")
    writer.Save()
    with pytest.raises(SourceError, match=r"walk\.usdz: is composed of other files \('.*pyramid\.usda'\), which are not read"):
        read_animated(tmp_path / "walk.usdz")


@pytest.mark.parametrize("packed", [False, True])
@pytest.mark.parametrize(("begin", "end"), [('def Xform "a" {\n', "}\n"), ("(", ")"), ("custom double[] a = [", "]")])
def test_text_nested_beyond_reason_ends_in_words_and_not_in_the_process(tmp_path, begin, end, packed):
    text = "#usda 1.0\n" + begin * 20_000 + end * 20_000
    path = tmp_path / ("deep.usdz" if packed else "deep.usda")
    if packed:
        with zipfile.ZipFile(path, "w") as archive:
            archive.writestr("deep.usda", text)
    else:
        path.write_text(text)
    with pytest.raises(SourceError, match=r"deep\.usd.: its prims or values are nested more than 1000 deep"):
        AnimatedUsd(path)


def unfolding(arc, levels):
    """A body that holds ten of another that hold ten of another, and so on."""
    head = "#usda 1.0\n(\n    startTimeCode = 0\n    endTimeCode = 5\n)\n"
    places = "float3[] points.timeSamples = {0: [(0,0,0),(1,0,0),(0,1,0)], 5: [(0,0,0),(1,0,0),(0,2,0)]}"
    mesh = f'def Mesh "m" {{\n {places}\n int[] faceVertexCounts = [3]\n int[] faceVertexIndices = [0,1,2]\n}}\n'
    text = f'{head}def "root" ({arc} = </c{levels - 1}>) {{}}\nclass "c0" {{\n{mesh}}}\n'
    for k in range(1, levels):
        text += f'class "c{k}" {{\n' + "".join(f'def "k{j}" ({arc} = </c{k - 1}>) {{}}\n' for j in range(10)) + "}\n"
    return text


@pytest.mark.parametrize("arc", ["inherits", "specializes", "references", "payload"])
@pytest.mark.parametrize("packed", [False, True])
def test_stage_that_unfolds_without_bound_is_refused_before_it_is_composed(tmp_path, monkeypatch, arc, packed):
    path = tmp_path / ("walk.usdz" if packed else "walk.usda")

    def write(levels):
        if packed:
            with zipfile.ZipFile(path, "w") as archive:
                archive.writestr("walk.usda", unfolding(arc, levels))
        else:
            path.write_text(unfolding(arc, levels))

    monkeypatch.setattr(animated_usd, "_MOST_PRIMS", 500)
    write(3)
    if packed or arc in ("inherits", "specializes"):
        assert len(AnimatedUsd(path).mesh(5)[1]) == 100
        write(5)
        with pytest.raises(SourceError, match=r"walk\.usd.: its stage has more than 500 prims, as often as they are inherited"):
            AnimatedUsd(path)
    else:
        with pytest.raises(SourceError, match="is composed of other files"):
            AnimatedUsd(path)


@pytest.mark.parametrize(("limit", "most"), [("_MOST_VERTICES", 299), ("_MOST_FACES", 99)])
def test_meshes_are_counted_before_they_are_put_together(tmp_path, monkeypatch, limit, most):
    (tmp_path / "walk.usda").write_text(unfolding("inherits", 3))
    frames = AnimatedUsd(tmp_path / "walk.usda")
    assert len(frames.mesh(0)[0]) == 300
    monkeypatch.setattr(animated_usd, limit, most)
    monkeypatch.setattr(animated_usd.np, "concatenate", pytest.fail)
    with pytest.raises(SourceError, match=rf"walk\.usda, frame 0: more than .*\b{most}\b.*; no frame needs as many"):
        frames.mesh(0)


def test_package_that_refers_to_a_file_whose_name_begins_like_its_own_is_refused(stage, tmp_path):
    stage.GetRootLayer().Export(str(tmp_path / "walk.usdz_other.usda"))
    text = f"#usda 1.0\n(\n    subLayers = [@{tmp_path / 'walk.usdz_other.usda'}@]\n)\n"
    with zipfile.ZipFile(tmp_path / "walk.usdz", "w") as archive:
        archive.writestr("root.usda", text)
    with pytest.raises(SourceError, match="is composed of other files"):
        AnimatedUsd(tmp_path / "walk.usdz")
