"""What the README says is so."""

import re
import shlex
from pathlib import Path

import pytest

from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.graph import AnyTask
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.methods import METHODS

ROOT = Path(__file__).resolve().parent.parent
README = (ROOT / "README.md").read_text()
SHELL = "\n".join(re.findall(r"```sh\n(.*?)```", README, re.DOTALL))
COMMANDS = command_line(APPLICATION).commands


def test_drawn_graph_has_the_shelves_and_their_edges() -> None:
    (drawn,) = re.findall(r"```mermaid\n(.*?)\n```", README, re.DOTALL)
    edges = {tuple(edge) for edge in re.findall(r"(\w+) --> (\w+)", drawn)}
    assert edges == {
        (shelf(read), shelf(task))
        for graph in METHODS.values()
        for task in graph.tasks
        for read in graph.reads(task)
        if shelf(read) != shelf(task)
    }


def shelf(task: AnyTask) -> str:
    """The shelf that a task stands on."""
    return task.module.split(".")[2]


@pytest.mark.parametrize("line", re.findall(r"^kinetree .*$", SHELL, re.MULTILINE))
def test_every_command_in_it_exists_with_its_options(line: str) -> None:
    words = shlex.split(line, comments=True)
    command = COMMANDS[words[1]]
    known = {option for param in command.params for option in param.opts}
    assert {w.split("=")[0] for w in words[2:] if w.startswith("-")} <= known


@pytest.mark.parametrize("path", re.findall(r"\]\((?!https?:)([^)#]+)\)", README))
def test_every_link_in_it_leads_somewhere(path: str) -> None:
    assert (ROOT / path).exists()


@pytest.mark.parametrize("command", sorted(COMMANDS))
def test_every_command_is_told_in_it(command: str) -> None:
    assert re.search(rf"^kinetree {command}\b", SHELL, re.MULTILINE)


def test_test_command_is_the_one_ci_runs() -> None:
    assert "make test" in README
    assert "make test" in (ROOT / ".ci" / "run").read_text()
