"""`kinetree demo`: computes the example, says where the results are and what to do next."""

import json
import shlex
from dataclasses import replace
from pathlib import Path

import pytest

from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.graph import Graph
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.commands.demo import demo
from kinetree.tasks.input.sequence import sequence
from kinetree.tasks.input.source import source


def test_demo_computes_the_example_and_names_commands_that_there_are(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    with replace(APPLICATION, methods=lambda: {"mesoscopic": Graph.of((source, sequence))}).active():
        demo(Path("walk demo"))
        printed = capsys.readouterr().out
        demo(Path("walk demo"))
        assert "done: 0 ran, 1 fresh" in capsys.readouterr().out
    assert printed.startswith("done: 1 ran, 0 fresh")
    assert f"results: {tmp_path / 'walk demo'}\n" in printed
    summary = json.loads((tmp_path / "walk demo" / "run.json").read_text())
    assert summary["status"] == "done"
    commands = command_line(APPLICATION).commands
    following = [shlex.split(line, comments=True) for line in printed.splitlines() if line.startswith("  kinetree")]
    assert [words[1] for words in following] == ["view", "show", "evaluate", "run"]
    assert all(words[1] in commands and "walk demo" in words for words in following[:3])
