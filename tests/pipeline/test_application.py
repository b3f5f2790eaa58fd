"""The loom runs whatever product is passed to it; its command line imports a command when it is called."""

import contextlib
import json
import os
import subprocess
import sys
from dataclasses import replace
from importlib.metadata import EntryPoint

import pytest

from kinetree.errors import ConfigError, UnknownNodeError
from kinetree.pipeline import application
from kinetree.pipeline.application import Application, Command, Section, Shortcut, built_in, current
from kinetree.pipeline.command_line.cli import command_line
from kinetree.pipeline.inspect import Pipeline
from kinetree.tasks.application import APPLICATION

HEAVY = {"numpy", "numba", "dask", "distributed", "scipy", "zarr", "matplotlib", "trimesh", "networkx"}
IMPORTED = """
import sys
from kinetree.tasks.application import main
try:
    main()
except SystemExit as end:
    print(end.code, *sorted({name.partition(".")[0] for name in sys.modules}), file=sys.stderr)
"""


def imported(*arguments, **env):
    """What one command line prints and the top-level modules that are loaded when it ends."""
    command = [sys.executable, "-c", IMPORTED, *arguments]
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **env})
    code, *modules = done.stderr.split()
    assert code == "0", done.stderr
    return done.stdout, set(modules)


@pytest.mark.parametrize("arguments", [[], ["--help"], ["--version"], *([name, "--help"] for name in APPLICATION.commands)])
def test_help_and_version_import_nothing_heavy(arguments):
    printed, modules = imported(*arguments)
    assert printed
    assert not modules & HEAVY
    if arguments in ([], ["--help"], ["--version"]):
        assert "rich" not in modules


def test_what_computes_imports_what_it_needs(tmp_path):
    body = ("synth", "snake", "--frames", "1", "--vertices", "200", "--output", str(tmp_path / "snake"))
    assert {"numpy", "numba"} <= imported(*body)[1]


@pytest.mark.parametrize(
    ("words", "offered"),
    [
        ("kinetree ", set(APPLICATION.commands)),
        ("kinetree r", {"reproduce", "run", "runs"}),
        ("kinetree run --inp", {"--input"}),
    ],
)
def test_shell_completes_commands_and_options_without_importing_them(words, offered):
    count = str(len(words.split(" ")) - 1)
    printed, modules = imported(_KINETREE_COMPLETE="complete_bash", COMP_WORDS=words, COMP_CWORD=count)
    assert set(printed.split()) == offered
    assert not modules & (HEAVY if "--" in words else HEAVY | {"rich"})  # no command is imported to complete its name


def test_shell_completion_shows_the_summaries():
    printed, _ = imported(_KINETREE_COMPLETE="complete_zsh", _TYPER_COMPLETE_ARGS="kinetree g")
    assert all(APPLICATION.commands[name].summary in printed for name in ("graph", "gc"))


# ── another product ─────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.fixture
def adding(toys, tmp_path, monkeypatch):
    """A product that has nothing of kinetree's: other methods, no presets, one shortcut."""
    monkeypatch.chdir(tmp_path)
    run, plan, show = (built_in(name) for name in ("run", "plan", "show"))
    folder = Shortcut(("--folder", "-f"), "source.input", "Folder of numbers.", "FOLDER", is_input=True)
    return Application(
        "adding",
        "Adds numbers that stand in files.",
        lambda: {"toy": toys.module.GRAPH, "toy again": toys.module.GRAPH},
        sections=(Section("Work", (run, plan)), Section("Look", (show,))),
        shortcuts=(folder,),
        first_steps=(("adding run --folder NUMBERS", "add them"),),
    )


@pytest.fixture
def run(capsys):
    """Runs a command line in this process; what it printed."""

    def run(product, *arguments):
        with product.active():
            assert not command_line(product)(list(map(str, arguments)), prog_name=product.name, standalone_mode=False)
        return capsys.readouterr().out

    return run


def test_another_product_has_its_own_help_and_first_steps(adding, run):
    printed = run(adding, "--help")
    assert "Usage: adding" in printed
    assert "Adds numbers that stand in files." in printed
    assert printed.index("Work:") < printed.index("  run ") < printed.index("Look:") < printed.index("  show ")
    assert "kinetree" not in printed
    assert "adding run --folder NUMBERS" in run(adding)
    helped = run(adding, "run", "--help")
    assert "--folder" in helped
    assert "--input" not in helped


def test_another_product_runs_with_its_first_method_and_its_own_folder(adding, run, toys, tmp_path):
    summary = json.loads(run(adding, "run", "-f", toys.frames, "--executor", "sync", "--json"))
    assert summary["status"] == "done"
    assert (tmp_path / "adding-output" / "run.json").is_file()
    assert "value: 210" in run(adding, "show", "total") or "210" in run(adding, "show", "total")
    assert json.loads(run(adding, "plan", "--json"))["counts"].keys() == {"fresh"}
    assert Pipeline.of(application=adding).config.method == "toy"


def test_a_shortcut_wins_over_set_and_set_suffices_to_name_the_input(adding, run, toys):
    nodes = json.loads(run(adding, "plan", "--set", f"source.input={toys.flags}", "-f", toys.frames, "--json"))["nodes"]
    assert "points[frame=5]" in {node["node"] for node in nodes}
    assert json.loads(run(adding, "plan", "--set", f"source.input={toys.frames}", "--json"))["nodes"] == nodes


def test_without_anything_to_work_on_the_products_own_option_is_named(adding, run):
    with pytest.raises(ConfigError, match=r"\(run and plan also take --folder FOLDER\)"):
        run(adding, "plan")
    with pytest.raises(ConfigError, match=r"name a configuration or an output folder$"):
        run(replace(adding, shortcuts=()), "plan")


def test_a_product_without_presets_says_so(adding):
    with pytest.raises(ConfigError, match="no such file, output folder or preset; presets: none"):
        Pipeline.of("demo", application=adding)
    with pytest.raises(ConfigError, match=r"neither a preset \(there are none\) nor a file"):
        Pipeline.of({"extends": "demo"}, application=adding)
    with pytest.raises(ConfigError, match="compute 'laptop': no such compute settings; there are: none"):
        Pipeline.of({"compute": "laptop"}, application=adding)


# ── which product ───────────────────────────────────────────────────────────────────────────────────────────────────


def test_the_product_whose_command_line_runs_comes_before_the_one_installed(adding):
    assert current() is APPLICATION
    with adding.active():
        assert current() is adding
    with contextlib.suppress(ZeroDivisionError), adding.active():
        raise ZeroDivisionError
    assert current() is APPLICATION


@pytest.fixture
def installed(monkeypatch):
    """Replaces the entry points that are installed."""

    def replaced(*points):
        entries = tuple(EntryPoint(name, value, application.ENTRY_POINTS) for name, value in points)
        monkeypatch.setattr(application, "entry_points", lambda group: entries)

    return replaced


def test_where_the_installation_names_no_product_it_is_to_be_made_again(installed):
    installed()
    with pytest.raises(ConfigError, match=r"expected one application, found none: .*install it again \(pip install \.\)"):
        Pipeline.of()


def test_of_several_installed_products_one_has_to_be_passed(installed):
    installed(("one", "nowhere:NOTHING"), ("two", "nowhere:NOTHING"))
    with pytest.raises(ConfigError, match="expected one application, found one, two; pass one with application=…"):
        Pipeline.of()


@pytest.mark.parametrize("value", ["kinetree.nowhere:NOTHING", "kinetree.tasks.application:NOTHING"])
def test_an_installation_older_than_the_code_is_to_be_made_again(installed, value):
    installed(("kinetree", value))
    message = rf"entry point kinetree = {value}: cannot be imported: .*; install the package again \(pip install \.\)"
    with pytest.raises(ConfigError, match=message):
        Pipeline.of()


def test_commands_are_found_where_they_are_said_to_be(adding):
    assert {command.imported().__name__ for command in adding.commands.values()} == {"run", "plan", "show"}
    with pytest.raises(KeyError):
        built_in("fly")
    with pytest.raises(ModuleNotFoundError):
        Command("fly", "Fly.", "no.such.module:fly").imported()


def test_a_pipeline_knows_the_names_that_its_product_gave_up():
    for look in (lambda p: p.plan(until=["tips"]), lambda p: p.why("tips[frame=3]"), lambda p: p.plan(force=["tips"])):
        with pytest.raises(UnknownNodeError, match=r"^no task 'tips'; it is now 'extrema'$"):
            look(Pipeline.of({"source": {"synth": {"frames": 2}}}, application=APPLICATION))
