"""Whatever byte of a store is altered: it is noticed and mended, or it changes no result."""

import random
from pathlib import Path

import pytest

from kinetree.errors import StoreError
from kinetree.pipeline.planning.verify import discard_damage, verify
from kinetree.pipeline.storage.gc import collect
from kinetree.pipeline.storage.store import MARKER, Store

FLIPS = 3
"""Bytes altered in every file of the store."""


def store(toys):
    return Store.at(toys.output / "store")


def files(folder):
    return sorted(p for p in folder.rglob("*") if p.is_file())


def values(toys):
    """Every artifact of the graph, read whole."""
    there = toys.pipeline().inspect()
    entries = [e for e in there.schedule.entries.values() if not e.task.is_origin]
    return {e.label: (e.artifact, there.schedule.value(e.node).plain()) for e in entries if e.artifact}


def test_sound_store_is_sound(toys):
    toys.run()
    report = verify(store(toys), [toys.module.GRAPH])
    assert report.is_sound
    assert report.lines() == []
    assert report.artifacts == len(set(toys.artifacts().values())) - 6


def test_every_altered_byte_is_noticed_or_harmless(toys):
    toys.run()
    graph, expected, rng = toys.module.GRAPH, values(toys), random.Random(0)
    kinds = {"noticed": 0, "harmless": 0}
    for path in files(toys.output / "store"):
        data = path.read_bytes()
        for place in rng.sample(range(len(data)), min(FLIPS, len(data))):
            path.write_bytes(data[:place] + bytes([data[place] ^ 1 << rng.randrange(8)]) + data[place + 1 :])
            if path.name == MARKER:
                with pytest.raises(StoreError, match="its format is"):
                    store(toys)
                continue
            is_sound = verify(store(toys), [graph]).is_sound
            if is_sound and "artifacts" in path.parts:
                assert all(values(toys)[label] == value for label, value in expected.items())
            kinds["harmless" if is_sound else "noticed"] += 1
        path.write_bytes(data)
    assert kinds["noticed"] > 2 * kinds["harmless"]


def test_repair_computes_again_what_was_damaged_and_nothing_else(toys):
    toys.run()
    calm = values(toys)
    toys.clear()
    for node, damage in (("points[frame=2]", flip), ("total", Path.unlink)):
        damage(store(toys).place.root / "artifacts" / calm[node][0][:2] / f"{calm[node][0]}.zip")
    report = verify(store(toys), [toys.module.GRAPH])
    assert sorted(label for nodes in report.nodes.values() for label in nodes) == ["points[frame=2]", "total"]
    assert any("(total): it is missing" in line for line in report.lines())
    discard_damage(store(toys), report)
    assert toys.run().ran == {"points[frame=2]", "total"}
    assert verify(store(toys), [toys.module.GRAPH]).is_sound
    assert values(toys) == calm


def test_record_of_another_configuration_whose_artifact_is_damaged_is_dropped(toys):
    toys.run()
    digest = toys.artifacts()["points[frame=2]"]
    toys.run(points={"scale": 2.0})
    flip(store(toys).place.root / "artifacts" / digest[:2] / f"{digest}.zip")
    discard_damage(store(toys), verify(store(toys), [toys.module.GRAPH]))
    assert verify(store(toys), [toys.module.GRAPH]).is_sound
    assert toys.run(points={"scale": 2.0}).ran == set()
    assert toys.run().ran == {"points[frame=2]"}


def flip(path):
    data = path.read_bytes()
    path.write_bytes(data[:60] + bytes([data[60] ^ 255]) + data[61:])


@pytest.mark.parametrize("where", ["records", "packs", "runs", "nodes"])
def test_damaged_records_and_runs_are_named_and_repaired(toys, where):
    toys.run()
    calm = values(toys)
    toys.run(until=("total",), force=("total",))  # which leaves a record of its own
    for path in files(toys.output / "store" / where):
        path.write_bytes(path.read_bytes()[:-1])
    process = toys.command("verify", str(toys.output))
    assert process.returncode == 1
    assert "cannot be read" in process.stdout
    repaired = toys.command("verify", str(toys.output), "--repair")
    assert repaired.returncode == 0, repaired.stderr
    assert toys.command("verify", str(toys.output)).stdout.endswith("artifacts read; nothing is damaged\n")
    toys.run()
    assert values(toys) == calm


def test_artifact_altered_at_equal_size_is_mended_by_a_node_that_computes_it_anew(toys):
    toys.run()
    digest = toys.artifacts()["smooth[frame=1]"]
    path = store(toys).place.root / "artifacts" / digest[:2] / f"{digest}.zip"
    sound = path.read_bytes()
    flip(path)
    toys.run(force=("smooth",))
    assert path.read_bytes() == sound


def test_artifact_of_a_class_that_is_not_known_is_checked_by_its_digests(toys):
    toys.run()
    digest = toys.artifacts()["points[frame=1]"]
    assert verify(store(toys), []).is_sound
    flip(store(toys).place.root / "artifacts" / digest[:2] / f"{digest}.zip")
    assert list(verify(store(toys), []).damaged) == [digest]


def test_recent_runs_are_kept_by_age_and_old_ones_let_go_by_size(toys):
    toys.run()
    toys.run(points={"scale": 2.0})
    both = sum(path.stat().st_size for path in files(toys.output / "store" / "artifacts"))
    assert collect(store(toys), days=1, dry=True).artifacts == ()
    assert collect(store(toys), days=1, size=both, dry=True).artifacts == ()
    first = store(toys).run_names()[0]
    assert collect(store(toys), days=1, size=both - 1, dry=True).runs == (first,)
    assert collect(store(toys), days=1, size=0, keep=[first], dry=True).runs == (store(toys).run_names()[1],)
    assert len(collect(store(toys), size=0, dry=True).runs) == 2
    done = toys.command("gc", str(toys.output), "--keep-days", "2", "--max-size", "1 GB", "--dry-run")
    assert done.stdout.startswith("would delete 0 artifacts")
    assert toys.command("gc", str(toys.output), "--max-size", "much").returncode == 2


def test_sealed_files_in_place_of_each_other_are_damage_and_no_traceback(toys):
    toys.run()
    toys.run(points={"scale": 1.3})
    place = toys.output / "store"
    there = {name: sorted(path for path in (place / name).iterdir() if path.is_file()) for name in ("runs", "nodes", "records")}
    others = [(there[name] or sorted((place / "packs").iterdir()))[0].read_bytes() for name in there]
    others.append(there["runs"][1].read_bytes())
    for path in (there["runs"][0], there["nodes"][0]):
        whole = path.read_bytes()
        for other in others:
            path.write_bytes(other)
            pipeline = toys.pipeline()
            assert len(pipeline.runs()) >= 1
            pipeline.plan()
            pipeline.inspect().estimate()
            collect(pipeline.store, dry=True)
            verify(pipeline.store, [pipeline.tasks])
        path.write_bytes(whole)
    assert toys.run(points={"scale": 1.3}).ran == set()
