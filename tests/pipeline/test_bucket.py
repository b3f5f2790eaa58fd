"""A store in a bucket of a server that speaks S3 over HTTP: laws of a place, slow answers, refusals, two runs at once."""

import time

import pytest
from s3_service import SECRET

from kinetree.errors import StoreError
from kinetree.pipeline.planning.verify import verify
from kinetree.pipeline.storage.gc import collect
from kinetree.pipeline.storage.store import Store, artifact_path


@pytest.fixture
def url(service):
    return f"s3://{service.bucket}/deep/store"


def test_what_a_place_promises_a_bucket_keeps(url):
    place = Store.at(url).place
    assert (place.get("x"), place.size("x"), place.tail("x", 9), place.part("x", 0, 3), place.names("")) == (None,) * 4 + ([],)
    assert place.modified("x") == 0
    place.remove("x")
    place.put("a/b.json", b"hello")
    place.put("a/c/d", b"")
    assert (place.get("a/b.json"), place.size("a/b.json"), place.part("a/b.json", 1, 3)) == (b"hello", 5, b"el")
    assert (place.tail("a/b.json", 2), place.tail("a/b.json", 99)) == ((b"lo", 5), (b"hello", 5))
    assert place.tail("a/c/d", 9) == (b"", 0)
    assert (place.names(""), place.names("a")) == (["a"], ["b.json", "c"])
    assert abs(place.modified("a/b.json") - time.time()) < 600
    place.put("a/b.json", b"other")
    assert place.get("a/b.json") == b"other"
    place.remove("a")
    assert place.names("") == []


def test_run_into_a_bucket_is_up_to_date_afterwards_and_sound(toys, url, service, tmp_path):
    service.pause, service.refuse_every = 0.002, 9
    toys.run(store=str(tmp_path / "calm"))
    assert len(toys.run(store=url).ran) == 40
    assert service.refused > 10
    assert toys.run(store=url).ran == set()
    assert toys.artifacts(store=url) == toys.artifacts(store=str(tmp_path / "calm"))
    store = Store.at(url)
    assert verify(store, [toys.module.GRAPH]).is_sound
    assert store.place.names("records") == []
    toys.run(store=url, intervals={"length": 3})
    assert len(collect(store).records) == 14
    assert toys.run(store=url, intervals={"length": 3}).ran == set()
    assert not (toys.output / "store").exists()


def uploaded(toys, url, frames):
    """Frames computed into a folder and put under an address; returns the blocks that name it."""
    toys.write(*(10.0 * (n + 1) for n in range(frames)))
    chosen = {"intervals": {"length": 1000}, "source": {"frames": f":{frames}"}}
    blocks = {**chosen, "store": str(toys.output / f"store{frames}")}
    toys.run(**blocks)
    place = Store.at(f"{url}{frames}").place
    for path in Store.at(blocks["store"]).place.listed(""):
        place.put(path, Store.at(blocks["store"]).place.get(path))
    return {**chosen, "store": f"{url}{frames}"}


def test_planning_lists_and_asks_for_no_artifact_alone(toys, url, service):
    """However many nodes there are, up to date or stale: as many requests, but for a listing more each thousand objects."""
    stores = {frames: uploaded(toys, url, frames) for frames in (6, 30)}
    for changes in ({}, {"points": {"scale": 1.3}}, {"smooth": {"grain": 5.0}}):
        requests = []
        for frames, blocks in stores.items():
            service.asked.clear()
            plan = toys.pipeline(**blocks, **changes).plan()
            counts = service.asked.copy()
            assert plan.counts["stale"] == frames if changes else plan.is_done
            assert counts["LIST"] <= 12
            requests.append((counts["GET"], counts["HEAD"]))
        assert requests[0] == requests[1]
        assert requests[0][1] <= 2


def test_plan_from_a_listing_sees_what_is_missing_or_cut(toys, url, service):
    blocks = uploaded(toys, url, 6)
    store = Store.at(blocks["store"])
    artifact_of = {node.node: node.artifact for node in toys.pipeline(**blocks).plan().nodes}
    store.discard(artifact_of["points[frame=3]"])
    store.place.put(artifact_path(artifact_of["smooth[frame=4]"]), b"PK")
    plan = toys.pipeline(**blocks).plan()
    assert sorted(node.node for node in plan.nodes if node.state == "stale") == ["points[frame=3]", "smooth[frame=4]"]


def test_collection_asks_for_no_artifact_alone(toys, url, service):
    requests = []
    for frames in (6, 30):
        blocks = uploaded(toys, url, frames)
        store = Store.at(blocks["store"])
        for digest in list(store.artifacts()):
            store.place.put(artifact_path(f"{digest[::-1]}"), b"PK")  # nobody's
        service.asked.clear()
        freed = collect(store)
        requests.append((service.asked["GET"], service.asked["HEAD"], service.asked["POST"]))
        assert len(freed.artifacts) == len(store.artifacts())
    assert requests[0] == requests[1]
    assert requests[0][1] <= 2


def test_two_runs_at_once_share_a_bucket(toys, url, service, tmp_path):
    service.pause = 0.002
    toys.flag("wait-points-10")
    runs = [
        toys.start("run", str(toys.yaml()), "--output", str(tmp_path / f"out{n}"), "--store", url, "--quiet") for n in (1, 2)
    ]
    toys.until(lambda: toys.executions().count("points-10") == 2, "both compute the first frame", *runs)
    (toys.flags / "wait-points-10").unlink()
    for run in runs:
        _, err = run.communicate(timeout=120)
        assert run.returncode == 0, err
    assert toys.run(store=url).ran == set()


def test_credentials_are_neither_stored_nor_printed(toys, url, service, tmp_path):
    process = toys.command("run", str(toys.yaml()), "--store", url, "--until", "points")
    assert process.returncode == 0, process.stderr
    place = Store.at(url).place
    objects = [o["path"] for chunk in place._store.list("deep/store/") for o in chunk]
    assert len(objects) > 6
    stored = b"".join(place.get(key.removeprefix("deep/store/")) for key in objects)
    exported = b"".join(p.read_bytes() for p in toys.output.rglob("*") if p.is_file())
    assert SECRET.encode() not in stored + exported + (process.stdout + process.stderr).encode()


def test_bucket_that_is_not_there_is_refused_in_words(service):
    with pytest.raises(StoreError) as refused:
        Store.at("s3://no-such-bucket/store").create()
    assert str(refused.value).startswith("store s3://no-such-bucket/store: cannot ")
    assert "AWS_ENDPOINT_URL" in str(refused.value)
    assert SECRET not in str(refused.value)
