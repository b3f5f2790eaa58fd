"""Laws of the command: what every command prints and returns, on a sequence of three tetrahedra."""

import importlib
import json
import os
import re
import signal
import subprocess
import sys

import numpy as np
import pytest
import yaml

from kinetree.errors import KinetreeError, MeshError
from kinetree.pipeline import inspect
from kinetree.pipeline.command_line import cli, queries
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.inspection.show import statistics
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.tasks.application import APPLICATION, main

TETRAHEDRON = "OFF\n4 4 0\n0 0 0\n{x} 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n"
READING = ["plan", "why", "graph", "show", "runs", "diff", "gc", "tasks"]
COMMANDS = list(APPLICATION.commands)


@pytest.fixture
def kinetree(capsys, tmp_path, monkeypatch):
    """Runs the command in this process, in an empty folder: (exit code, what it printed, what it complained)."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(signal, "signal", lambda *_: None)  # the test's own process keeps its handlers
    monkeypatch.setattr(cli, "_leave", sys.exit)  # … and its life

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["kinetree", *map(str, arguments)])
        with pytest.raises(SystemExit) as end:
            main()
        printed = capsys.readouterr()
        assert "Traceback" not in printed.err
        return end.value.code, printed.out, printed.err

    return run


@pytest.fixture
def scans(tmp_path):
    folder = tmp_path / "scans"
    folder.mkdir()
    for t in range(3):
        (folder / f"{t}.off").write_text(TETRAHEDRON.format(x=1 + t / 10))
    return folder


@pytest.fixture
def walked(kinetree, scans):
    """An output folder after one run until the sequence and the meshes are there."""
    code, _, complained = kinetree("run", "-i", "scans", "-o", "walk", "--until", "connectivity", "--executor", "sync", "-q")
    assert (code, complained) == (0, "")
    return "walk"


def parsed(printed):
    return json.loads(printed)


# ── help, version, misuse ───────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("command", COMMANDS)
def test_help_of_every_command_has_an_example(kinetree, command):
    code, printed, _ = kinetree(command, "--help")
    assert code == 0
    assert "Example" in printed
    assert f"kinetree {command}" in " ".join(printed.split())


@pytest.mark.parametrize("command", ["why", "show"])
def test_help_writes_a_node_with_its_index(kinetree, command):
    _, printed, _ = kinetree(command, "--help")
    assert "mesh[frame=3]" in printed


def test_help_names_every_command_and_the_exit_codes(kinetree):
    code, printed, _ = kinetree("--help")
    assert code == 0
    assert all(f" {command} " in printed for command in COMMANDS)
    codes = "0 done · 1 nodes failed · 2 the input is wrong · 3 cluster or service failed, try again · 130 interrupted"
    assert codes in " ".join(printed.split())


def test_bare_command_says_how_to_begin(kinetree):
    code, printed, complained = kinetree()
    assert (code, complained) == (0, "")
    begins = [words for line in printed.splitlines() if (words := line.split()[:2])[:1] == ["kinetree"]]
    assert begins == [["kinetree", word] for word in ("demo", "run", "view", "--help")]


def test_commands_stand_in_their_sections_in_the_order_of_a_persons_work(kinetree):
    _, printed, _ = kinetree("--help")
    titles = [line for line in printed.splitlines() if re.fullmatch(r"\w[\w ]*:", line)]
    assert titles == ["Start:", "Many sequences:", "Look:", "Take away:", "Configure:", "Make:", "Care:", "Options:"]
    names = re.findall(r"^  ([a-z]+) ", printed.partition("Start:")[2].partition("Options:")[0], re.MULTILINE)
    order = "demo run view dataset show plan why graph tasks runs diff export plot evaluate compare reproduce config synth"
    order += " silhouettes convert gc verify"
    assert names == order.split()


@pytest.mark.parametrize("command", APPLICATION.commands.values(), ids=lambda command: command.name)
def test_summary_in_the_list_is_the_first_line_of_the_commands_own_help(command):
    assert (command.imported().__doc__ or "").splitlines()[0] == command.summary


def test_version_is_printed(kinetree):
    from importlib.metadata import version

    assert kinetree("--version") == (0, f"{version('kinetree')}\n", "")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["run", "--nonsense"], "No such option: --nonsense"),
        (["plna"], "No such command 'plna'"),
        (["why"], "Missing argument"),
        (["run", "--workers", "many"], "Invalid value for '--workers'"),
        (["gc", "walk", "--keep-last", "-1"], "Invalid value for '--keep-last'"),
        (["run", "a", "b"], "unexpected extra argument"),
    ],
)
def test_misuse_is_one_message_that_points_to_help(kinetree, arguments, words):
    code, _, complained = kinetree(*arguments)
    assert code == 2
    assert words in complained
    assert "Try kinetree --help" in complained


def test_without_anything_to_work_on_it_says_what_to_name(kinetree):
    for command in (["run"], ["plan"], ["runs"], ["gc"], ["why", "mesh[0]"], ["show", "mesh[0]"]):
        code, _, complained = kinetree(*command)
        assert code == 2
        assert complained == (
            "kinetree: nothing to work on: name a configuration or an output folder (run and plan also take --input FOLDER)\n"
        )


# ── run ─────────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_run_says_what_it_did_and_where_the_results_are(kinetree, scans, tmp_path):
    code, printed, complained = kinetree("run", "-i", "scans", "-o", "walk", "--until", "connectivity", "--executor", "sync")
    assert code == 0
    first, *remarks, second = printed.splitlines()
    expected = "connectivity: fixed connectivity: all frames have the same 4 faces, so nothing has to be aligned"
    assert remarks == [expected]
    assert first.startswith("done: 5 ran, 0 fresh in ")
    assert second == f"results: {tmp_path / 'walk'}"
    assert "mesh: 3 ran, 0 fresh" in complained
    code, printed, complained = kinetree("run", "walk", "--until", "connectivity")
    assert code == 0
    assert printed.startswith("done: 0 ran, 5 fresh in ")


def test_run_looks_at_the_input_and_the_store_once(kinetree, walked, monkeypatch):
    laid_out = []
    monkeypatch.setattr(inspect, "Schedule", lambda *a, **named: laid_out.append(a) or Schedule(*a, **named))
    code, printed, _ = kinetree("run", walked, "--until", "connectivity", "--executor", "sync")
    assert code == 0
    assert "0 ran" in printed
    assert "nothing has to be aligned" in printed
    assert len(laid_out) == 1


def test_run_leaves_its_account_and_its_configuration(kinetree, walked, tmp_path):
    account = json.loads((tmp_path / "walk" / "run.json").read_text())
    assert account["status"] == "done"
    assert account["nodes"] == {"ran": 5, "fresh": 0, "failed": 0, "skipped": 0}
    assert set(account["tasks"]) == {"mesh", "sequence", "connectivity"}
    assert {"ran", "fresh", "failed", "seconds"} <= set(account["tasks"]["mesh"])
    assert account["failures"] == []
    assert {"seconds", "versions"} <= set(account)
    saved = yaml.safe_load((tmp_path / "walk" / "config.yaml").read_text())
    assert saved["source"] == {"input": "../scans"}


def test_run_prints_its_account_as_json(kinetree, scans, tmp_path):
    code, printed, complained = kinetree("run", "-i", "scans", "-o", "w", "--until", "sequence", "--json")
    assert (code, complained) == (0, "")
    printed_account = parsed(printed)
    assert printed_account.pop("run") in [r["name"] for r in parsed(kinetree("runs", "w", "--json")[1])]
    account = json.loads((tmp_path / "w" / "run.json").read_text())
    assert printed_account == {key: account[key] for key in printed_account}


def test_quiet_run_prints_nothing(kinetree, scans):
    assert kinetree("run", "-i", "scans", "-o", "w", "--until", "sequence", "-q") == (0, "", "")


def test_log_has_one_event_a_line(kinetree, scans, tmp_path):
    kinetree("run", "-i", "scans", "-o", "w", "--until", "mesh", "-q", "--log-json", "log.jsonl", "--executor", "sync")
    events = [json.loads(line) for line in (tmp_path / "log.jsonl").read_text().splitlines()]
    kinds = [e["event"] for e in events]
    assert kinds[0] == "run"
    assert kinds[-1] == "end"
    assert kinds.count("start") == kinds.count("finish") == 3
    assert {e["node"] for e in events if e["event"] == "finish"} == {f"mesh[frame={t}]" for t in range(3)}


def test_log_that_cannot_be_written_is_refused_before_anything_runs(kinetree, scans, tmp_path):
    for log in ("scans", "nowhere/log"):
        code, _, complained = kinetree("run", "-i", "scans", "-o", "w", "--log-json", log)
        assert code == 2
        assert complained.startswith(f"kinetree: --log-json {log}: cannot be written: ")
    assert not (tmp_path / "w").exists()


def test_options_win_over_set_and_set_over_the_file(kinetree, scans, tmp_path):
    (tmp_path / "w.yaml").write_text("source: {input: nothing, frames: '2:'}\noutput: a\n")
    code, printed, _ = kinetree("plan", "w.yaml", "-i", "scans", "--set", "source.frames=1:", "--frames", "0:2", "--json")
    assert code == 0
    nodes = [n["node"] for n in parsed(printed)["nodes"]]
    assert {"mesh[frame=0]", "mesh[frame=1]"} <= set(nodes)
    assert "mesh[frame=2]" not in nodes


def test_frames_keep_their_numbers(kinetree, scans):
    code, printed, _ = kinetree("plan", "-i", "scans", "--frames", "0:3:2", "--json")
    assert code == 0
    assert {n["node"] for n in parsed(printed)["nodes"] if n["task"] == "mesh"} == {"mesh[frame=0]", "mesh[frame=2]"}


@pytest.mark.parametrize(
    "name", ["with space", "[1] scans", "scäns 日本", "😀", "a'b\"c", "tab\there", "#1: x", "~me", "%s{x}"]
)
def test_input_and_output_may_be_called_anything(kinetree, scans, tmp_path, name):
    scans.rename(tmp_path / name)
    code, _, complained = kinetree("run", "-i", name, "-o", f"out {name}", "--until", "sequence", "-q")
    assert (code, complained) == (0, "")
    code, printed, _ = kinetree("plan", f"out {name}", "--until", "sequence")
    assert code == 0
    assert "everything is up to date" in printed


def test_force_runs_what_is_fresh(kinetree, walked):
    code, printed, _ = kinetree("run", walked, "--until", "mesh", "--force", "mesh", "--json", "--executor", "sync")
    assert code == 0
    assert parsed(printed)["tasks"]["mesh"]["ran"] == 3


@pytest.mark.parametrize("option", ["--until", "--force"])
def test_mistyped_task_is_refused_with_the_nearest(kinetree, walked, option):
    assert kinetree("run", walked, option, "mehs")[::2] == (2, "kinetree: no task 'mehs'; did you mean 'mesh'?\n")


def test_failed_node_is_told_and_exits_1(kinetree, scans, monkeypatch):
    home = importlib.import_module("kinetree.tasks.input.mesh")
    clean = home.clean

    def refusing(V, F, *, name, **settings):
        if name.endswith("1.off"):
            raise MeshError(f"{name}: has no face with an area")
        return clean(V, F, name=name, **settings)

    monkeypatch.setattr(home, "clean", refusing)
    code, printed, complained = kinetree("run", "-i", "scans", "-o", "w", "--until", "connectivity", "--executor", "sync")
    assert code == 1
    assert printed.startswith("failed: 3 ran, 0 fresh, 1 failed, 1 skipped")
    assert "mesh[frame=1]: MeshError: " in complained
    code, printed, complained = kinetree("run", "w", "--until", "connectivity", "-q")
    assert (code, printed) == (1, "")
    assert complained.count("mesh[frame=1]: MeshError: ") == 1
    code, printed, _ = kinetree("run", "w", "--until", "connectivity", "--json")
    assert code == 1
    assert parsed(printed)["failures"][0]["node"] == "mesh[frame=1]"
    assert parsed(printed)["status"] == "failed"


def test_interrupt_exits_130_and_says_how_to_go_on(kinetree, scans, monkeypatch):
    def interrupted(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr(Pipeline, "run", interrupted)
    code, _, complained = kinetree("run", "-i", "scans", "-o", "w")
    assert code == 130
    assert "kinetree: interrupted; what is finished is kept, run again to go on" in complained


def test_error_of_ours_shows_where_it_came_from(capsys, monkeypatch, tmp_path):
    def broken(*_, **__):
        raise ZeroDivisionError("ours")

    monkeypatch.setattr(Pipeline, "of", broken)
    monkeypatch.setattr(signal, "signal", lambda *_: None)
    monkeypatch.setattr(sys, "argv", ["kinetree", "tasks"])
    with pytest.raises(SystemExit) as end:
        main()
    complained = capsys.readouterr().err
    assert end.value.code == 1
    assert "ZeroDivisionError: ours" in complained
    assert "this is an error in kinetree itself; the store is whole" in complained


@pytest.mark.parametrize("value", ["-1", "0", "many", "1.5"])
def test_number_of_threads_in_the_environment_that_is_none_is_refused(kinetree, monkeypatch, value):
    monkeypatch.setenv("NUMBA_NUM_THREADS", value)
    code, _, complained = kinetree("tasks")
    assert code == 2
    assert complained.startswith(f"kinetree: NUMBA_NUM_THREADS={value}: a number of threads from 1 on is expected")


@pytest.mark.parametrize("value", ["", "1"])
def test_number_of_threads_in_the_environment_is_left_alone(kinetree, monkeypatch, value):
    monkeypatch.setenv("NUMBA_NUM_THREADS", value)
    assert kinetree("tasks")[0] == 0


def test_refusal_that_is_not_the_users_exits_1_without_traceback(kinetree, monkeypatch):
    def broken(*_, **__):
        raise KinetreeError("the graph is bent")

    monkeypatch.setattr(Pipeline, "of", broken)
    assert kinetree("tasks")[::2] == (1, "kinetree: the graph is bent\n")


# ── reading ─────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_plan_tells_states_and_reasons(kinetree, walked):
    code, printed, _ = kinetree("plan", walked, "--set", "mesh.component_share=0.1", "--until", "connectivity")
    assert code == 0
    assert "mesh ×3: 3 stale — params: component_share 0.05 → 0.1 ×3" in printed
    assert "connectivity: waits — waits for mesh[frame=0], mesh[frame=1], mesh[frame=2]" in printed
    code, printed, _ = kinetree("plan", walked, "--until", "connectivity", "--nodes")
    assert "mesh[frame=1]: fresh\n" in printed
    assert "everything is up to date; a run would compute nothing" in printed


def test_plan_as_json(kinetree, walked):
    plan = parsed(kinetree("plan", walked, "--until", "connectivity", "--json")[1])
    assert set(plan) == {"counts", "tasks", "nodes"}
    assert plan["counts"] == {"fresh": 8}
    assert set(plan["nodes"][0]) == {"node", "task", "state", "reasons", "waits", "key", "artifact"}
    assert set(plan["tasks"][0]) == {"task", "over", "states", "reasons", "unknown"}


def test_planning_writes_nothing(kinetree, scans, tmp_path):
    assert kinetree("plan", "-i", "scans", "-o", "w")[0] == 0
    assert not (tmp_path / "w").exists()


def test_why_tells_state_and_neighbours(kinetree, walked):
    code, printed, _ = kinetree("why", "mesh[1]", walked)
    assert code == 0
    assert printed.startswith("mesh[frame=1]: fresh\n  reads source[frame=1]\n  is read by ")
    assert "connectivity" in printed
    answer = parsed(kinetree("why", "mesh[1]", walked, "--set", "mesh.merge=0", "--json")[1])
    assert set(answer) == {"node", "state", "waits", "reasons", "reads", "feeds"}
    assert answer["state"] == "stale"
    assert answer["reasons"] == [{"kind": "params", "what": "merge 1e-07 → 0.0"}]


@pytest.mark.parametrize("command", ["why", "show"])
def test_node_that_is_not_there_is_refused(kinetree, walked, command):
    assert kinetree(command, "mesh[7]", walked)[::2] == (2, "kinetree: mesh[7]: no such node; mesh has 3 nodes\n")
    assert kinetree(command, "mehs[7]", walked)[::2] == (2, "kinetree: no task 'mehs'; did you mean 'mesh'?\n")
    code, _, complained = kinetree(command, "\x1b[2J[red]mesh", walked)
    assert code == 2
    assert "\x1b" not in complained
    assert "[red]mesh" in complained


def test_show_tells_schema_shapes_statistics_and_provenance(kinetree, walked):
    code, printed, _ = kinetree("show", "mesh[1]", walked)
    assert code == 0
    for words in (
        "float64 (vertex, xyz=3) in length",
        "4×3, 0 … 1.1, mean",
        "Position of every vertex.",
        "params: merge 1e-07",
    ):
        assert words in printed
    answer = parsed(kinetree("show", "mesh[1]", walked, "--json")[1])
    assert answer["node"] == "mesh[frame=1]"
    assert answer["arrays"]["vertices"]["shape"] == [4, 3]
    assert {"key", "code", "versions", "seconds", "peak_bytes_of_the_process", "inputs", "params"} <= set(answer["made"])


def test_a_single_number_is_shown_as_itself():
    content = {"arrays": {"volume": statistics(np.array(3.5)), "gap": statistics(np.array(np.nan))}}
    assert queries._value(content, "volume") == "3.5"
    assert queries._value(content, "gap") == "not finite"


def test_show_of_what_was_not_computed_tells_its_schema(kinetree, scans):
    (scans.parent / "w.yaml").write_text("source: {input: scans}")
    code, printed, _ = kinetree("show", "mesh[1]", "w.yaml")
    assert code == 0
    assert "mesh[frame=1]: stale (never ran)" in printed


@pytest.mark.parametrize("form", ["mermaid", "dot", "json"])
def test_graph_of_the_method_and_of_a_sequence(kinetree, walked, form):
    begins = {"mermaid": "flowchart TD\n", "dot": "digraph tasks {\n", "json": "{"}[form]
    for arguments in ([], [walked], [walked, "--expanded"]):
        code, printed, _ = kinetree("graph", *arguments, "--format", form)
        assert code == 0
        assert printed.startswith(begins)
    assert ("mesh[frame=1]" in printed) == (form != "nothing")


def test_graph_groups_mapped_nodes(kinetree, walked):
    assert "mesh ×3: 3 fresh" in kinetree("graph", walked)[1]
    drawn = parsed(kinetree("graph", walked, "--json")[1])
    assert {"from": "source", "to": "mesh", "argument": "source", "form": "one", "previous": False} in drawn["edges"]
    assert next(n for n in drawn["nodes"] if n["name"] == "mesh")["states"] == {"fresh": 3}


def test_wrong_drawing_is_refused(kinetree):
    assert kinetree("graph", "--format", "png")[::2] == (2, "kinetree: --format png: expected dot, json or mermaid\n")
    code, _, complained = kinetree("graph", "--expanded")
    assert code == 2
    assert "name a configuration or an output folder" in complained


def test_runs_diff_and_gc_tell_what_changed_between_runs(kinetree, walked):
    code, _, _ = kinetree("run", walked, "--until", "connectivity", "--set", "mesh.component_share=0.1", "-q")
    assert code == 0
    rows = parsed(kinetree("runs", walked, "--json")[1])
    assert [r["status"] for r in rows] == ["done", "done"]
    a, b = (r["name"] for r in rows)
    assert a in kinetree("runs", walked)[1]
    answer = parsed(kinetree("diff", a, b, walked, "--json")[1])
    assert set(answer) == {"a", "b", "only_a", "only_b", "changed", "begins"}
    assert answer["begins"]["mesh[frame=0]"] == ["params: component_share 0.05 → 0.1"]
    assert answer["changed"] == []
    assert "0 nodes have other results" in kinetree("diff", a, b, walked)[1]
    code, printed, _ = kinetree("gc", walked, "--dry-run")
    assert code == 0
    assert printed.startswith("would delete ")
    freed = parsed(kinetree("gc", walked, "--json")[1])
    assert set(freed) == {"runs", "records", "artifacts", "leftovers", "bytes"}
    assert freed["runs"] == [a]
    assert "everything is up to date" in kinetree("plan", walked, "--until", "connectivity")[1]


@pytest.mark.parametrize("name", ["nothing", "../../records/x", "\x1b[31m"])
def test_run_that_is_not_there_is_refused(kinetree, walked, name):
    for arguments in (["diff", name, name, walked], ["gc", walked, "--keep", name]):
        code, _, complained = kinetree(*arguments)
        assert code == 2
        assert complained.startswith("kinetree: no run ")
        assert complained.endswith("kinetree runs lists them\n")
        assert "\x1b" not in complained


def test_tasks_are_the_table_of_contents(kinetree):
    code, printed, _ = kinetree("tasks")
    assert code == 0
    assert "mesh: Source, Isosurface of all → Mesh per frame" in printed
    assert "mesh.component_share = 0.05" in printed
    assert "set by kinematic_tree.degrees, kinematic_tree.ratio, kinematic_tree.hidden_bones\n" in printed
    rows = parsed(kinetree("tasks", "--json")[1])
    assert {r["task"]: r["set_by"] for r in rows if r["set_by"]} == {
        "rigid_parts": [f"rigid_parts.{name}" for name in ("rings", "patches", "removal_cost")],
        "extended_tree": ["kinematic_tree.surface_joints"],
        "kinematic_tree": [
            f"kinematic_tree.{name}" for name in ("hidden_bones", "necks", "narrowings", "mirrored_joints", "spine")
        ],
        "cut_poses": [f"rigid_parts.{name}" for name in ("rings", "patches", "removal_cost", "cuts")],
        "further_cut": [f"kinematic_tree.{name}" for name in ("degrees", "ratio", "hidden_bones")],
        "first_tree": [
            f"kinematic_tree.{name}"
            for name in (
                "degrees",
                "ratio",
                "hidden_bones",
                "clear_motion",
                "misfit_ratio",
                "misfit_ratio_if_moving",
            )
        ],
        "agreed_tree": [
            f"kinematic_tree.{name}"
            for name in ("degrees", "ratio", "clear_motion", "misfit_ratio", "misfit_ratio_if_moving", "end_joints")
        ],
    }
    mesh = next(r for r in rows if r["task"] == "mesh")
    assert set(mesh) == {"task", "over", "reads", "writes", "on_request", "params", "set_by", "along", "paper", "summary"}
    assert mesh["params"]["component_share"]["default"] == 0.05
    assert mesh["reads"] == [
        {"argument": "source", "artifact": "Source", "form": "one", "previous": False},
        {"argument": "isosurface", "artifact": "Isosurface", "form": "tuple", "previous": False},
    ]


def test_config_is_printed_in_full_and_read_back(kinetree, walked, tmp_path):
    code, printed, _ = kinetree("config", walked, "--set", "mesh.component_share=0.125")
    assert code == 0
    assert yaml.safe_load(printed)["mesh"]["component_share"] == 0.125


def test_output_folder_is_found_from_within(kinetree, walked, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path / "walk")
    assert "everything is up to date" in kinetree("plan", "--until", "connectivity")[1]


# ── the true command ────────────────────────────────────────────────────────────────────────────────────────────────


def command(*arguments, **env):
    code = "from kinetree.tasks.application import main; main()"
    return subprocess.run(
        [sys.executable, "-c", code, *arguments], capture_output=True, env={**os.environ, **env}, check=False, timeout=120
    )


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (("--output", "s3://bucket/walk"), "--output s3://bucket/walk: output: s3://bucket/walk is the address of a service"),
        (("--store", "ftp://host/walk"), "--store ftp://host/walk: store: ftp://host/walk is the address of a service"),
        (
            ("--names", "nm/mixamo.yaml"),
            "--names nm/mixamo.yaml: joint_names.style: a run takes a style: kinetree, mixamo, smpl, openpose, vrm, isb, none;",
        ),
        (("--names", "mixamoo"), "--names mixamoo: joint_names.style: input should be 'kinetree', "),
    ],
)
def test_an_option_whose_value_is_refused_is_named_as_it_was_typed(kinetree, scans, arguments, words):
    code, _, complained = kinetree("plan", "-i", "scans", *arguments)
    assert (code, complained[: len(f"kinetree: {words}")]) == (2, f"kinetree: {words}")


def test_a_run_says_where_a_file_of_names_goes(kinetree, scans):
    code, _, complained = kinetree("plan", "-i", "scans", "--names", "names.yaml")
    assert code == 2
    assert "a file of names is for kinetree export --names FILE, and joint_names.rename sets single names" in complained


def test_terminal_that_knows_only_ascii_still_gets_an_answer(scans, tmp_path):
    done = command("plan", "-i", str(scans), "--set", "report.title=μ", PYTHONIOENCODING="ascii", PYTHONUTF8="0")
    assert done.returncode == 0, done.stderr
    assert b"mesh \\xd73: 3 stale" in done.stdout


def test_reader_that_stops_listening_is_no_error_of_ours(scans):
    code = "from kinetree.tasks.application import main; main()"
    shell = f"'{sys.executable}' -c '{code}' plan -i '{scans}' --json | head -n 1"
    done = subprocess.run(["/bin/sh", "-c", shell], capture_output=True, text=True, timeout=120, check=True)
    assert done.stdout == "{\n"
    assert "Traceback" not in done.stderr
