"""The command `kinetree`: what it takes and what it prints; everything it does is `Pipeline`'s."""

import contextlib
import errno
import io
import json
import os
import signal
import sys
import threading
import traceback
from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path
from typing import Annotated, Any, NoReturn

import typer
from rich.console import Console
from rich.markup import escape
from rich.table import Table

from kinetree.pipeline import config as configuration
from kinetree.pipeline import gc as collection
from kinetree.pipeline.draw import Format, draw
from kinetree.pipeline.errors import ConfigError, InputError, KinetreeError
from kinetree.pipeline.events import JsonLog, Listener
from kinetree.pipeline.explain import explained
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.plan import Plan
from kinetree.pipeline.printable import printable
from kinetree.pipeline.progress import LiveProgress, PlainProgress, clock
from kinetree.pipeline.show import shown

EXITS = "Exit codes: 0 done · 1 nodes failed · 2 the input is wrong · 130 interrupted"
app = typer.Typer(
    name="kinetree",
    help="Kinematic structure of a moving body from 3D video: a tree of joints and bones from meshes whose vertices and"
    " connectivity change in every frame.",
    epilog=EXITS,
    no_args_is_help=True,
    pretty_exceptions_enable=False,
    rich_markup_mode="rich",
)

Target = Annotated[
    str | None,
    typer.Argument(
        metavar="[CONFIG]",
        help="A YAML file, a preset's name, or the output folder of an earlier run. Left out: this folder, if it is one.",
        show_default=False,
    ),
]
Set = Annotated[
    list[str] | None, typer.Option("--set", metavar="TASK.NAME=VALUE", help="Override one parameter; may be repeated.")
]
Input = Annotated[
    str | None, typer.Option("--input", "-i", help="Folder or glob of meshes, one a frame; or one .npz or zarr file.")
]
Output = Annotated[str | None, typer.Option("--output", "-o", help="Folder for the results.")]
StoreAt = Annotated[str | None, typer.Option("--store", help="Folder for what is computed; default: OUTPUT/store.")]
Frames = Annotated[str | None, typer.Option("--frames", metavar="START:STOP:STEP", help="Frames wanted, e.g. 10:60:2.")]
Until = Annotated[list[str] | None, typer.Option("--until", metavar="TASK", help="Stop after this task; may be repeated.")]
Force = Annotated[list[str] | None, typer.Option("--force", metavar="TASK", help="Run this task though it is fresh.")]
ENVIRONMENT = (
    errno.EACCES, errno.EPERM, errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.ENAMETOOLONG, errno.EIO, errno.EMFILE,
    errno.ENFILE, errno.ELOOP, errno.ENOTDIR, errno.ESTALE, errno.ENOMEM,
)  # fmt: skip
"""What a system refuses for reasons that lie in it and not in kinetree."""
REMARKS = 12
"""Remarks printed after a run."""
GATHERS = {"one": "", "tuple": " of all", "mapping": " of all", "previous": " before it"}
AsJson = Annotated[bool, typer.Option("--json", help="Print JSON.")]
out = Console(soft_wrap=True, highlight=False, width=None if sys.stdout.isatty() else 200)  # a pipe cuts no table short
err = Console(stderr=True, soft_wrap=True, highlight=False)


@app.command(epilog=f"Examples: kinetree run --input scans/ --output walk/ · kinetree run walk.yaml --until mesh\n\n{EXITS}")
def run(
    config: Target = None,
    source: Input = None,
    output: Output = None,
    store: StoreAt = None,
    frames: Frames = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    workers: Annotated[int | None, typer.Option("--workers", help="How many at the same time; default: one per core.")] = None,
    executor: Annotated[str | None, typer.Option("--executor", help="sync, threads or processes.")] = None,
    scheduler: Annotated[str | None, typer.Option("--scheduler", metavar="ADDRESS", help="A running dask scheduler.")] = None,
    quiet: Annotated[bool, typer.Option("--quiet", "-q", help="Print nothing but errors.")] = False,
    log_json: Annotated[Path | None, typer.Option("--log-json", metavar="FILE", help="One event a line.")] = None,
    as_json: AsJson = False,
) -> None:
    """Compute what is not fresh and say where the results are."""
    pipeline = _pipeline(config, source, output, store, frames, sets)
    compute = configuration.with_compute(pipeline.config, workers=workers, executor=executor, scheduler=scheduler)
    pipeline = Pipeline.of(compute)
    with _progress(pipeline, quiet or as_json, log_json) as listeners:
        told = pipeline.run(until=until or (), force=force or (), listeners=listeners)
    if as_json:
        _print_json(told)
    elif not quiet:
        _print_summary(told, pipeline)
    if told["status"] == "failed":
        if quiet:
            _print_failures(told)
        raise typer.Exit(1)


@app.command(epilog="Examples: kinetree plan walk.yaml · kinetree plan walk/ --set mesh.component_share=0.1 --json")
def plan(
    config: Target = None,
    source: Input = None,
    output: Output = None,
    store: StoreAt = None,
    frames: Frames = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    nodes: Annotated[bool, typer.Option("--nodes", help="One line a node instead of one a task.")] = False,
    as_json: AsJson = False,
) -> None:
    """Say what a run would compute and why; computes nothing."""
    found = _pipeline(config, source, output, store, frames, sets).plan(until=until or (), force=force or ())
    if as_json:
        _print_json(found.json())
    else:
        _print_plan(found, nodes)


@app.command(name="config", epilog="Examples: kinetree config > walk.yaml · kinetree config paper-2014 · kinetree config walk/")
def config_(config: Target = None, sets: Set = None) -> None:
    """Print the whole configuration as YAML, every parameter with its value and what it means."""
    pipeline = Pipeline.of(config, sets=sets or ())
    typer.echo(explained(pipeline.config, pipeline.tasks), nl=False)


@app.command(epilog='Examples: kinetree why "mesh[frame=3]" walk/ · kinetree why skeleton walk/')
def why(node: Annotated[str, typer.Argument(help="A node, e.g. mesh[frame=3] or connectivity.")], config: Target = None,
        sets: Set = None, as_json: AsJson = False) -> None:  # fmt: skip
    """Say why one node is fresh, stale or waiting, and what it is made from."""
    pipeline = _pipeline(config, sets=sets)
    planned = pipeline.why(node)
    lineage = pipeline.lineage(node)
    reads, feeds = sorted(lineage.predecessors(planned.node)), sorted(lineage.successors(planned.node))
    if as_json:
        _print_json({"node": planned.node, "state": planned.state, "waits": list(planned.waits),
                     "reasons": [{"kind": r.kind, "what": r.what} for r in planned.reasons],
                     "reads": reads, "feeds": feeds})  # fmt: skip
        return
    out.print(printable(planned), markup=False)
    for word, names in (("reads", reads), ("feeds", feeds)):
        if names:
            more = f" and {len(names) - 8} more" if len(names) > 8 else ""
            out.print(printable(f"  {word} {', '.join(names[:8])}{more}"), markup=False)


@app.command(epilog="Examples: kinetree graph · kinetree graph walk/ --format dot | dot -Tsvg > graph.svg")
def graph(
    config: Target = None,
    form: Annotated[str, typer.Option("--format", help="mermaid, dot or json.")] = "mermaid",
    expanded: Annotated[bool, typer.Option("--expanded", help="One node a frame instead of one a task.")] = False,
    as_json: AsJson = False,
) -> None:
    """Draw the graph as text: of a configuration with the state of its nodes, or of the method alone."""
    if form not in ("mermaid", "dot", "json"):
        raise ConfigError(f"--format {form}; there are: dot, json, mermaid")
    chosen: Format = "json" if as_json else form  # type: ignore[assignment]
    target = config if config is not None else _here()
    if target is None and expanded:
        raise ConfigError("--expanded draws the nodes of a sequence; name a config or an output folder")
    drawn = Pipeline.of().tasks.networkx() if target is None else Pipeline.of(target).graph(expanded=expanded)
    typer.echo(draw(drawn, chosen))


@app.command(epilog='Example: kinetree show "mesh[frame=3]" walk/')
def show(node: Annotated[str, typer.Argument(help="A node, e.g. mesh[frame=3].")], config: Target = None,
         sets: Set = None, as_json: AsJson = False) -> None:  # fmt: skip
    """Show what a node holds: schema, shapes, statistics, and how it was made."""
    told = shown(_pipeline(config, sets=sets), node)
    if as_json:
        _print_json(told)
        return
    out.print(printable(told["why"]), markup=False)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("field", "type", "value", "what"):
        table.add_column(name, overflow="fold")
    for name, field in told["schema"]["fields"].items():
        table.add_row(name, escape(field["type"]), escape(printable(_value(told, name))), escape(field["what"]))
    out.print(table)
    for name, value in (told.get("made") or {}).items():
        out.print(printable(f"{name}: {_brief(value)}"), markup=False)


@app.command(epilog="Example: kinetree runs walk/")
def runs(config: Target = None, as_json: AsJson = False) -> None:
    """List the runs on record in the store, oldest first."""
    found = _pipeline(config).runs()
    if as_json:
        _print_json(found)
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("run", "status", "ran", "fresh", "failed", "seconds", "output"):
        table.add_column(name, overflow="fold")
    for row in found:
        told = [str(row.get("counts", {}).get(name, "")) for name in ("ran", "fresh", "failed")]
        fields = [row["name"], row["status"], *told, row.get("seconds", ""), row["output"]]
        table.add_row(*(escape(printable(field)) for field in fields))
    out.print(table)


@app.command(epilog="Example: kinetree diff 20250301-081500-123ab 20250302-081500-4560c walk/")
def diff(run_a: Annotated[str, typer.Argument(help="A run, as kinetree runs names it.")],
         run_b: Annotated[str, typer.Argument(help="Another run.")], config: Target = None,
         as_json: AsJson = False) -> None:  # fmt: skip
    """Say what differs between two runs, and from where."""
    told = _pipeline(config).diff(run_a, run_b)
    if as_json:
        _print_json(told)
        return
    for word, names in (("only in the first", told["only_a"]), ("only in the second", told["only_b"])):
        if names:
            out.print(printable(f"{word}: {_brief(names)}"), markup=False)
    for label, reasons in told["begins"].items():
        out.print(printable(f"begins at {label}: {'; '.join(reasons)}"), markup=False)
    out.print(f"{len(told['changed'])} nodes have other results{': ' + _brief(told['changed']) if told['changed'] else ''}",
              markup=False)  # fmt: skip


@app.command(epilog="Examples: kinetree gc walk/ --dry-run · kinetree gc walk/ --keep-last 3")
def gc(
    config: Target = None,
    keep: Annotated[list[str] | None, typer.Option("--keep", metavar="RUN", help="Keep what this run used.")] = None,
    keep_last: Annotated[int | None, typer.Option("--keep-last", min=0, help="Keep the last N runs of each output.")] = None,
    dry_run: Annotated[bool, typer.Option("--dry-run", help="Only say what would be freed.")] = False,
    store: StoreAt = None,
    as_json: AsJson = False,
) -> None:
    """Free what none of the kept runs needs; without options the last run of each output folder is kept."""
    pipeline = _pipeline(config, store=store)
    garbage = collection.collect(pipeline.store, keep=keep or (), last=keep_last, dry=dry_run)
    if as_json:
        _print_json(garbage.json())
    else:
        out.print(f"{'would free' if dry_run else 'freed'} {garbage} in {printable(pipeline.store.url)}", markup=False)


@app.command(epilog="Example: kinetree tasks --json")
def tasks(as_json: AsJson = False) -> None:
    """The table of contents: each task with its inputs, output, parameters and the paper's section."""
    rows = [_task_row(task) for task in Pipeline.of().tasks.tasks]
    if as_json:
        _print_json(rows)
        return
    for row in rows:
        reads = ", ".join(f"{a['artifact']}{GATHERS[a['form']]}" for a in row["reads"]) or "the files"
        per = f" per {row['over']}" if row["over"] else ""
        out.print(f"[bold]{row['task']}[/bold]: {reads} → {row['writes']}{per}  [dim]{escape(row['paper'])}[/dim]")
        out.print(f"    {escape(row['summary'])}")
        for name, param in row["params"].items():
            out.print(f"    [cyan]{row['task']}.{name}[/cyan] = {escape(str(param['default']))}  {escape(param['what'])}")


@app.callback(invoke_without_command=True)
def _root(show_version: Annotated[bool, typer.Option("--version", help="Print the version.")] = False) -> None:
    if show_version:
        typer.echo(version("kinetree"))
        raise typer.Exit


def command_line() -> typer.Typer:
    """The whole command line: the loom's commands and those of the tasks."""
    from kinetree.tasks.commands import register

    if not any(command.callback is not None and command.callback.__name__ == "synth" for command in app.registered_commands):
        register(app)
    return app


def main() -> NoReturn:
    """The console script: every refusal is one message and an exit code, never a traceback."""
    signal.signal(signal.SIGTERM, _interrupt)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that cannot show × must not end a run
    try:
        code = int(command_line()(standalone_mode=False) or 0)  # the command returns the code of a typer.Exit
    except InputError as error:
        _print_error(error)
        code = 2
    except KinetreeError as error:
        _print_error(error)
        code = 1
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    except BrokenPipeError:
        sys.stderr.close()
        code = 141
    except Exception as error:
        code = _unexpected(error)
    if code == 130:
        err.print("kinetree: interrupted; what is finished is kept, run again to go on", markup=False)
        if threading.active_count() > 1:
            _leave(code)
    raise SystemExit(code)


def _leave(code: int) -> NoReturn:
    """Ends the process though threads are in the middle of nodes, which may take minutes; the store is whole anyway."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def _unexpected(error: Exception) -> int:
    """Click's own refusals of options and arguments, and errors that are ours."""
    told = getattr(error, "format_message", None)
    if told is not None:
        if told():  # the help that a bare command asks for is printed already
            err.print(f"kinetree: {printable(told())}\nTry kinetree --help", markup=False, style="red")
        return 2
    if isinstance(error, OSError) and error.errno in ENVIRONMENT:
        err.print(f"kinetree: {printable(error.filename or 'the system')}: {error.strerror}", markup=False, style="red")
        return 2
    traceback.print_exception(error)
    err.print("kinetree: this is an error in kinetree itself; the store is whole. Please report it with the lines above.")
    return 1


def _print_error(error: KinetreeError) -> None:
    lines = isinstance(error, ConfigError)  # one line a key; elsewhere a line end is part of somebody's file name
    err.print(f"kinetree: {printable(error, lines=lines)}", markup=False, style="red")


def _interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt


def _pipeline(
    config: str | None,
    source: str | None = None,
    output: str | None = None,
    store: str | None = None,
    frames: str | None = None,
    sets: list[str] | None = None,
) -> Pipeline:
    """The pipeline that arguments and options name; options win over --set, and both over the file."""
    options = {"source.input": source, "source.frames": frames, "output": output, "store": store}
    told = [f"{key}={_quoted(str(value))}" for key, value in options.items() if value is not None]
    target = config if config is not None else (None if source else _here())
    if target is None and not source and store is None:
        raise ConfigError("nothing to work on: name a config or an output folder, or give --input FOLDER")
    return Pipeline.of(target, sets=[*(sets or ()), *told])


def _quoted(text: str) -> str:
    """The text as a YAML string, whatever characters a path has."""
    return '"' + "".join(c if c.isascii() and c.isalnum() else f"\\U{ord(c):08x}" for c in text) + '"'


def _here() -> str | None:
    """The current folder or ./kinetree-output, where it is the output of a run."""
    folders = (Path(), Path("kinetree-output"))
    return next((str(folder) for folder in folders if (folder / configuration.SAVED).is_file()), None)


@contextlib.contextmanager
def _progress(pipeline: Pipeline, quiet: bool, log: Path | None) -> Iterator[list[Listener]]:
    with contextlib.ExitStack() as stack:
        listeners: list[Listener] = []
        if log is not None:
            try:
                listeners.append(JsonLog(stack.enter_context(log.open("a", encoding="utf-8", errors="backslashreplace"))))
            except OSError as error:
                raise ConfigError(f"--log-json {log}: cannot be written: {error.strerror}; name another file") from None
        if not quiet:
            workers = pipeline.config.compute.worker_count
            if err.is_terminal:
                listeners.append(stack.enter_context(LiveProgress(err, workers)))
            else:
                listeners.append(stack.enter_context(PlainProgress(err, workers)))
        yield listeners


def _print_plan(found: Plan, nodes: bool) -> None:
    for row in found.nodes if nodes else found.tasks:
        out.print(printable(row), markup=False)
    if found.is_done:
        out.print("everything is fresh; a run would compute nothing")


def _print_summary(told: dict[str, Any], pipeline: Pipeline) -> None:
    counts = told["nodes"]
    line = ", ".join(f"{count} {name}" for name, count in counts.items() if count or name in ("ran", "fresh"))
    _print_failures(told)
    out.print(f"{told['status']}: {line} in {clock(told['seconds'])}")
    remarks = pipeline.remarks()
    for node, text in remarks[:REMARKS]:
        out.print(f"{node}: {printable(text)}", markup=False)
    if len(remarks) > REMARKS:
        out.print(f"… and {len(remarks) - REMARKS} more remarks")
    out.print(f"results: {printable(pipeline.config.output)}", markup=False)


def _print_failures(told: dict[str, Any]) -> None:
    for failure in told["failures"][:20]:
        line = printable(f"{failure['node']}: {failure['error']}: {failure['message']}")
        err.print(line, markup=False, style="red")
    if len(told["failures"]) > 20:
        err.print(f"… and {len(told['failures']) - 20} more, all in run.json", markup=False, style="red")


def _print_json(value: Any) -> None:
    typer.echo(json.dumps(value, indent=2, ensure_ascii=False, default=str))


def _task_row(task: Any) -> dict[str, Any]:
    fields = task.params.model_fields if task.params else {}
    return {
        "task": task.name,
        "over": "/".join(task.over),
        "reads": [{"argument": a.name, "artifact": a.artifact.__name__, "form": a.form} for a in task.arguments],
        "writes": task.returns.__name__,
        "params": {n: {"default": f.default, "what": f.description or ""} for n, f in fields.items()},
        "paper": task.paper,
        "summary": task.summary,
    }


def _value(told: dict[str, Any], name: str) -> str:
    if name in told.get("values", {}):
        return _brief(told["values"][name])
    stats = told.get("arrays", {}).get(name)
    if stats is None:
        return ""
    shape = "×".join(map(str, stats["shape"]))
    return f"{shape}, {stats['min']:.6g} … {stats['max']:.6g}, mean {stats['mean']:.6g}" if "min" in stats else shape


def _brief(value: Any) -> str:
    if isinstance(value, list | tuple):
        more = f" and {len(value) - 6} more" if len(value) > 6 else ""
        return ", ".join(map(str, value[:6])) + more
    if isinstance(value, dict):
        return ", ".join(f"{k} {_brief(v)}" for k, v in value.items())
    return str(value)
