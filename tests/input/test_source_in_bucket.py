"""Frames in a bucket are the frames of a folder: the same digests, the same meshes, the same refusals."""

import json

import numpy as np
import pytest
from s3_service import SECRET
from shapes import sphere

from kinetree.errors import InputError, SourceError
from kinetree.pipeline import Pipeline
from kinetree.pipeline.running.events import Account, Watch
from kinetree.pipeline.storage.files import Files
from kinetree.pipeline.storage.store import Store
from kinetree.schemas.input.source import SourceParams
from kinetree.tasks.input.source import source

V, F = sphere(1)


def off(scale):
    rows = [" ".join(map(str, v)) for v in V * scale] + [f"3 {a} {b} {c}" for a, b, c in F]
    return f"OFF\n{len(V)} {len(F)} 0\n" + "\n".join(rows) + "\n"


@pytest.fixture
def scans(tmp_path):
    """Four meshes and what is none."""
    folder = tmp_path / "scans"
    folder.mkdir()
    for t in (1, 2, 9, 10):
        (folder / f"frame_{t}.off").write_text(off(1 + t / 100))
    (folder / "truth.json").write_text("{}")
    return folder


@pytest.fixture
def place(service, scans):
    """The same in a bucket."""
    place = Store.at(f"s3://{service.bucket}/deep/scans").place
    for file in scans.iterdir():
        place.put(file.name, file.read_bytes())
    return place


def frames(where, files=None, **params):
    return source(SourceParams(input=str(where), **params), files)


@pytest.fixture
def files(tmp_path):
    return Files.of(Store.at(tmp_path / "store"))


@pytest.fixture
def pipeline(tmp_path, place):
    """A run of the meshes with two workers; the store is shared with a run over the folder."""

    def pipeline_of(where=place.url, executor="threads", name="out", **blocks):
        compute = {"executor": executor, "workers": 2}
        shared = {"output": str(tmp_path / name), "store": str(tmp_path / "store"), "compute": compute}
        return Pipeline.of({**shared, "source": {"input": str(where)}, **blocks})

    return pipeline_of


def contents(found):
    return {t: s.content for t, s in found.items()}


@pytest.mark.parametrize("ending", ["", "/", "/frame_*.off"])
def test_bucket_has_the_frames_of_the_folder_it_is_a_copy_of(scans, place, files, ending):
    assert contents(frames(place.url + ending, files)) == contents(frames(scans, files))
    assert [s.path for s in frames(place.url + ending, files).values()][2] == f"{place.url}/frame_9.off"
    assert list(frames(place.url, files, frames="2:10")) == [2, 9]


def test_run_over_a_copy_in_a_bucket_computes_nothing_again(scans, pipeline):
    assert pipeline(scans, name="local").run(until=["mesh"])["nodes"]["ran"] == 4
    assert pipeline().run(until=["mesh"])["nodes"] == {"ran": 0, "fresh": 4, "failed": 0, "skipped": 0}


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_workers_fetch_what_they_read_whatever_the_service_refuses(scans, pipeline, service, executor):
    service.pause, service.refuse_every = 0.005, 3
    there = pipeline(executor=executor)
    assert there.run(until=["mesh"])["nodes"]["ran"] == 4
    assert service.refused > 3
    local = pipeline(scans, name="local", store=str(there.config.output / "other"))
    local.run(until=["mesh"])
    assert [n.artifact for n in there.plan(until=["mesh"]).nodes] == [n.artifact for n in local.plan(until=["mesh"]).nodes]


def test_replaced_object_is_computed_again_and_no_other(pipeline, place):
    pipeline().run(until=["mesh"])
    place.put("frame_2.off", off(1.3).encode())
    assert [n.node for n in pipeline().plan(until=["mesh"]).nodes if n.state != "fresh"] == ["mesh[frame=2]"]
    assert pipeline().run(until=["mesh"])["nodes"]["ran"] == 1


def test_object_that_changes_or_goes_under_a_run_fails_its_frame_alone(pipeline, place):
    there = pipeline()
    snapshot, account = there.inspect(until=["mesh"]), Account()
    place.put("frame_2.off", off(1.3).encode())
    place.remove("frame_9.off")
    there._go(snapshot, Watch((account,)), None)
    messages = {failure["node"]: failure["message"] for failure in account.failures}
    assert sorted(messages) == ["mesh[frame=2]", "mesh[frame=9]"]
    assert messages["mesh[frame=2]"] == "frame_2.off: the file changed while the run was under way; run again"
    assert messages["mesh[frame=9]"].startswith(f"{place.url}/frame_9.off: there is no such object")


def test_object_that_is_no_mesh_is_dropped_with_its_reason(place, files):
    place.put("frame_2.off", b"OFF\n9 9")
    (bad,) = frames(place.url, files, bad_share=0.5)[1].dropped
    assert bad.frame == 2
    assert bad.reason.startswith("frame_2.off: ")


def test_one_npz_in_a_bucket_holds_all_frames(place, files, pipeline, tmp_path):
    arrays = {"vertices": np.concatenate([V * (1 + t / 10) for t in range(3)]), "faces": F}
    offsets = {"vertex_offsets": np.arange(4) * len(V), "face_offsets": np.array([0, len(F)])}
    np.savez(tmp_path / "walk.npz", **arrays, **offsets, fps=25.0)
    place.put("packed/walk.npz", (tmp_path / "walk.npz").read_bytes())
    packed_frames = frames(f"{place.url}/packed/walk.npz", files)
    assert contents(packed_frames) == contents(frames(tmp_path / "walk.npz", files))
    assert {s.fps for s in packed_frames.values()} == {25.0}
    assert pipeline(f"{place.url}/packed/walk.npz").run(until=["mesh"])["nodes"]["ran"] == 3


@pytest.mark.parametrize(("names", "words"), [
    (["a_1.png", "a_2.png"], r"no mesh among its files \(.png\); .* manifests and zarr are read from folders"),
    (["zarr.json"], "no mesh among its files"),
    (["a_1.ply", "a_2.obj"], r"meshes of several formats \(1 × .obj, 1 × .ply\); choose by a pattern such as \*.obj"),
    (["a_1.ply", "a_01.ply"], "two files have the same number"),
])  # fmt: skip
def test_what_is_not_served_is_refused_in_words(place, files, names, words):
    for name in names:
        place.put(f"other/{name}", b"")
    with pytest.raises(SourceError, match=words):
        frames(f"{place.url}/other", files)


def test_other_services_are_refused_in_words(files):
    with pytest.raises(SourceError, match=r"^https:// is not read; give a folder, .* or s3://bucket/folder$"):
        frames("https://example.org/scans", files)


def test_bucket_that_is_not_there_is_refused_in_words(service, files):
    with pytest.raises(InputError, match="^input s3://no-such-bucket: cannot .*AWS_ENDPOINT_URL") as refused:
        frames("s3://no-such-bucket/scans", files)
    assert SECRET not in str(refused.value)


def test_credentials_are_neither_kept_nor_told(pipeline, place):
    there = pipeline(source={"input": place.url, "bad_share": 0.5})
    place.put("frame_2.off", b"OFF")
    heard = []
    listener = type("Heard", (), {"hear": staticmethod(heard.append)})
    summary = there.run(until=["mesh"], listeners=[listener])
    folder = there.config.output.parent
    files_written = b"".join(p.read_bytes() for at in ("out", "store") for p in (folder / at).rglob("*") if p.is_file())
    assert place.url.encode() in files_written
    assert SECRET.encode() not in files_written + json.dumps([summary, heard], default=str).encode()
