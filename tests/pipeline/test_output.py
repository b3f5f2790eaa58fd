"""Laws of the output folder: configuration and account are left whole or not at all, whatever they hold."""

import errno
import json
import os
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from kinetree.errors import StoreError, StoreFullError
from kinetree.pipeline import views
from kinetree.pipeline.output.output import write_config, write_run_json
from kinetree.pipeline.settings.config import load
from kinetree.tasks.application import APPLICATION


@pytest.fixture
def config(tmp_path):
    return load({"output": str(tmp_path / "deep" / "out"), "report": {"title": "µm: #1"}}, APPLICATION)


def test_configuration_is_left_as_yaml_with_a_word_about_itself(config):
    write_config(config)
    text = (config.output / "config.yaml").read_text()
    assert text.startswith("# The configuration of the last run into this folder; what is not here is the default.\n")
    assert yaml.safe_load(text) == config.portable()
    assert load(config.output, APPLICATION) == config


def test_account_is_left_as_json(config):
    account = {"status": "failed", "failures": [{"message": "a\nb\x1b[31m µ"}]}
    write_run_json(config, account)
    text = (config.output / "run.json").read_text()
    assert json.loads(text) == account
    assert text.endswith("}\n")


def test_message_that_is_no_text_is_left_all_the_same(config):
    write_run_json(config, {"message": "name\udcff.ply"})
    assert json.loads((config.output / "run.json").read_text()) == {"message": "name\udcff.ply"}


def test_run_json_says_what_results_have_to_say_in_short_also_where_nothing_ran(toys):
    toys.run(until=("total",))
    assert "results" not in json.loads((toys.output / "run.json").read_text())
    views.summary_of(toys.module.Total)(lambda total: {"frames": list(total.frames)})
    again = toys.run(until=("total",))
    assert again.ran == set()
    results = {"total": {"frames": list(range(len(list(toys.frames.iterdir()))))}}
    assert json.loads((toys.output / "run.json").read_text())["results"] == again.told["results"] == results


def test_nothing_else_is_left_in_the_folder(config):
    write_config(config)
    write_run_json(config, {})
    assert sorted(p.name for p in config.output.iterdir()) == ["config.yaml", "run.json"]


@pytest.mark.parametrize(("code", "error"), [(errno.ENOSPC, StoreFullError), (errno.EACCES, StoreError)])
def test_refused_write_names_the_output_folder_and_keeps_what_was_there(config, monkeypatch, code, error):
    write_config(config)
    before = (config.output / "config.yaml").read_bytes()

    def refuse(path, data):
        raise OSError(code, os.strerror(code))

    monkeypatch.setattr(Path, "write_bytes", refuse)
    with pytest.raises(error, match=f"^output folder {config.output}: "):
        write_config(config)
    assert [p.name for p in config.output.iterdir()] == ["config.yaml"]
    assert (config.output / "config.yaml").read_bytes() == before


def test_file_in_place_of_the_folder_is_refused(config, tmp_path):
    (tmp_path / "file").write_text("mine")
    with pytest.raises(StoreError, match=r"^output folder .*/file: cannot write run\.json: "):
        write_run_json(replace(config, output=tmp_path / "file"), {})
