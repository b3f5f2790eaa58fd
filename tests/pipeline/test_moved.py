"""A moved output folder: it is the output wherever it lies, and what was computed in it is still there."""

import json
import shutil

import pytest
import yaml

from kinetree.errors import KinetreeError, ServiceError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.storage.files import Files


def moved(toys, to):
    """The output folder, elsewhere; nothing is left where it was."""
    shutil.move(toys.output, to)
    return to


def named(toys, folder, *sets):
    return Pipeline.of(folder, sets=sets, methods={"toy": toys.module.GRAPH})


def everything(folder):
    return {str(p.relative_to(folder)): p.read_bytes() for p in sorted(folder.rglob("*")) if p.is_file()}


def test_folder_that_is_named_is_the_output_and_its_store_the_store(toys, tmp_path):
    toys.run()
    there = shutil.copytree(toys.output, tmp_path / "far" / "copy")
    before = everything(toys.output)
    pipeline = named(toys, there, "smooth.grain=20")
    assert (pipeline.config.output, pipeline.config.store) == (there, there / "store")
    assert pipeline.run()["status"] == "done"
    assert everything(toys.output) == before
    assert json.loads((there / "run.json").read_text())["nodes"]["ran"] > 0


def test_moved_folder_is_up_to_date_and_runs_nothing(toys, tmp_path):
    toys.run()
    toys.clear()
    there = moved(toys, tmp_path / "moved")
    assert named(toys, there).plan().is_done
    assert named(toys, there).run()["status"] == "done"
    assert toys.executions() == []
    assert not toys.output.exists()


def test_folder_and_input_that_move_together_go_on_together(toys, tmp_path):
    toys.run()
    toys.clear()
    (tmp_path / "home").mkdir()
    there = moved(toys, tmp_path / "home" / "out")
    shutil.move(toys.frames, tmp_path / "home" / "frames")
    pipeline = named(toys, there)
    assert pipeline.config.params["source"].input == str(tmp_path / "home" / "frames")
    assert pipeline.run()["nodes"]["ran"] == 0


def test_configuration_names_what_is_near_by_the_way_to_it_and_what_is_far_by_its_place(toys, tmp_path):
    toys.run(output=str(tmp_path / "deep" / "out"), store=str(tmp_path / "deep" / "store"))
    saved = yaml.safe_load((tmp_path / "deep" / "out" / "config.yaml").read_text())
    assert (saved["output"], saved["store"]) == (".", "../store")
    assert saved["source"] == {"input": str(toys.frames)}


def test_configuration_of_a_folder_works_as_a_file_as_well(toys, tmp_path):
    toys.run()
    there = moved(toys, tmp_path / "moved")
    assert named(toys, there / "config.yaml").config == named(toys, there).config


def test_configuration_with_absolute_paths_gives_way_to_the_folder_that_is_named(toys, tmp_path):
    toys.run()
    (toys.output / "config.yaml").write_text(json.dumps({**toys.config(), "store": str(toys.output / "store")}))
    there = moved(toys, tmp_path / "moved")
    config = named(toys, there).config
    assert (config.output, config.store) == (there, there / "store")


def test_reasons_are_told_against_the_run_that_moved_with_the_folder(toys, tmp_path):
    toys.run()
    there = moved(toys, tmp_path / "moved")
    assert str(named(toys, there, "intervals.length=3").why("intervals")) == "intervals: stale (params: length 2 → 3)"


def test_run_without_its_input_is_read_from_its_own_record(toys, tmp_path):
    toys.run()
    toys.clear()
    there = moved(toys, tmp_path / "moved")
    shutil.rmtree(toys.frames)
    pipeline = named(toys, there)
    assert pipeline.plan().is_done
    assert pipeline.artifact("points", frame=2).x.tolist() == [30.0, 60.0, 90.0]
    summary = pipeline.run()
    assert (summary["status"], summary["nodes"]["ran"]) == ("done", 0)
    assert summary["notes"] == [f"source: no frames in {tmp_path / 'frames'}; what the last run found there is used"]
    assert named(toys, there, "smooth.grain=20").run()["status"] == "done"
    assert not {told for told in toys.executions() if told.startswith("points")}


def test_frames_on_record_do_not_stand_for_input_that_cannot_be_asked_for_now(toys, monkeypatch):
    def complete(*_):
        raise ServiceError("input s3://scans: the service answers 503")

    toys.run()
    monkeypatch.setattr(Files, "complete", complete)
    with pytest.raises(ServiceError, match="answers 503"):
        named(toys, toys.output).plan()


def test_frames_on_record_are_only_used_for_the_input_they_were_found_in(toys, tmp_path):
    toys.run()
    shutil.rmtree(toys.frames)
    with pytest.raises(KinetreeError, match="no frames in"):
        named(toys, toys.output, "source.frames=1:4").plan()
    with pytest.raises(KinetreeError, match="no frames in"):
        named(toys, toys.output, f"source.input={tmp_path / 'other'}").plan()
    with pytest.raises(KinetreeError, match="no frames in"):
        toys.pipeline().plan()  # the configuration names the input itself
