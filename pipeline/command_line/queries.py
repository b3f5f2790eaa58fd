"""The commands that only read: what there is, what is out of date and why, what it was made from."""

from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from kinetree.errors import ConfigError
from kinetree.pipeline.application import current
from kinetree.pipeline.command_line.options import (
    AsJson,
    Force,
    MadeWithOption,
    Output,
    Set,
    StoreAt,
    Target,
    Until,
    brief,
    here,
    out,
    pipeline_of,
    print_json,
)
from kinetree.pipeline.command_line.printable import printable

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline
    from kinetree.pipeline.inspection.draw import Format

GATHERS = {"one": "", "tuple": " of all", "mapping": " of all"}
NodeName = Annotated[str, typer.Argument(help="A task, or one node of it as plan --nodes prints it.")]


def plan(
    config: Target = None,
    output: Output = None,
    store: StoreAt = None,
    sets: Set = None,
    until: Until = None,
    force: Force = None,
    made_with: MadeWithOption = None,
    nodes: Annotated[bool, typer.Option("--nodes", help="Print one line per node instead of one per task.")] = False,
    estimate: Annotated[
        bool, typer.Option("--estimate", help="Say how long a run would compute, from what earlier runs took.")
    ] = False,
    as_json: AsJson = False,
) -> None:
    """Say what a run would compute and why, without computing anything.

    A node is fresh if its result is up to date, stale if a run would compute it, and waits if that depends on other nodes.
    """
    pipeline = pipeline_of(config, output, store, sets)
    there = pipeline.inspect(until=until or pipeline.tasks.unasked, force=force or (), made_with=made_with or ())
    planned, expected = there.plan, there.estimate() if estimate else None
    if as_json:
        print_json({**planned.json(), **({"estimate": expected.json()} if expected else {})})
        return
    for row in planned.nodes if nodes else planned.tasks:
        out.print(printable(row), markup=False)
    if planned.is_done:
        out.print("everything is up to date; a run would compute nothing")
    elif expected:
        out.print(printable(expected), markup=False)


def config(config: Target = None, sets: Set = None, as_json: AsJson = False) -> None:
    """Print every parameter with its value and meaning, as YAML."""
    from kinetree.pipeline.settings.explain import explained

    pipeline = _pipeline(config, sets)
    if as_json:
        params = {name: block.model_dump(mode="json") for name, block in pipeline.config.params.items()}
        print_json({"method": pipeline.config.method, **params})
        return
    typer.echo(explained(pipeline.config, pipeline.tasks), nl=False)


def why(node: NodeName, config: Target = None, sets: Set = None, as_json: AsJson = False) -> None:
    """Say whether a node is up to date and why.

    Also what it reads and what reads it.
    """
    there = pipeline_of(config, sets=sets).inspect()
    planned, lineage = there.why(node), there.lineage(node)
    reads, feeds = sorted(lineage.predecessors(planned.node)), sorted(lineage.successors(planned.node))
    if as_json:
        print_json({"node": planned.node, "state": planned.state, "waits": list(planned.waits),
                     "reasons": [{"kind": r.kind, "what": r.what} for r in planned.reasons],
                     "reads": reads, "feeds": feeds})  # fmt: skip
        return
    out.print(printable(planned), markup=False)
    for word, names in (("reads", reads), ("is read by", feeds)):
        if names:
            more = f" and {len(names) - 8} more" if len(names) > 8 else ""
            out.print(printable(f"  {word} {', '.join(names[:8])}{more}"), markup=False)


def graph(
    config: Target = None,
    form: Annotated[str, typer.Option("--format", help="mermaid, dot or json.")] = "mermaid",
    expanded: Annotated[bool, typer.Option("--expanded", help="Draw every node instead of every task.")] = False,
    as_json: AsJson = False,
) -> None:
    """Draw the graph of tasks as text.

    With a configuration, or in the output folder of a run, with the state of every task.
    """
    from kinetree.pipeline.inspection.draw import draw

    if form not in ("mermaid", "dot", "json"):
        raise ConfigError(f"--format {form}: expected dot, json or mermaid")
    chosen: Format = "json" if as_json else form  # type: ignore[assignment]
    target = config if config is not None else here()
    if target is None and expanded:
        raise ConfigError("--expanded draws the nodes of one input: name a configuration or an output folder")
    drawn = _pipeline().tasks.networkx() if target is None else _pipeline(target).graph(expanded=expanded)
    typer.echo(draw(drawn, chosen))


def show(node: NodeName, config: Target = None, sets: Set = None, as_json: AsJson = False) -> None:
    """Show what a node holds and how it was made.

    Its fields with their units and statistics; the parameters, inputs, code and versions it was made with.
    """
    from kinetree.pipeline.inspection.show import node_details

    content = node_details(pipeline_of(config, sets=sets), node)
    if as_json:
        print_json(content)
        return
    out.print(printable(content["why"]), markup=False)
    for line in (*content["told"], "") if content.get("told") else ():
        out.print(printable(line), markup=False)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("field", "type", "value", "what"):
        table.add_column(name, overflow="fold")
    for name, field in content["schema"]["fields"].items():
        table.add_row(name, escape(field["type"]), escape(printable(_value(content, name))), escape(field["what"]))
    out.print(table)
    for name, value in (content.get("made") or {}).items():
        out.print(printable(f"{name}: {brief(value)}"), markup=False)


def runs(config: Target = None, as_json: AsJson = False) -> None:
    """List the runs recorded in the store, oldest first."""
    recorded = pipeline_of(config).runs()
    if as_json:
        print_json(recorded)
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("run", "status", "ran", "fresh", "failed", "seconds", "output"):
        table.add_column(name, overflow="fold")
    for row in recorded:
        counts = [str(row.get("counts", {}).get(name, "")) for name in ("ran", "fresh", "failed")]
        cells = [row["name"], row["status"], *counts, row.get("seconds", ""), row["output"]]
        table.add_row(*(escape(printable(cell)) for cell in cells))
    out.print(table)


def diff(
    run_a: Annotated[str, typer.Argument(help="A run, as runs names it.")],
    run_b: Annotated[str, typer.Argument(help="Another run.")],
    config: Target = None,
    as_json: AsJson = False,
) -> None:
    """Say what differs between two runs and where it starts."""
    difference = pipeline_of(config).diff(run_a, run_b)
    if as_json:
        print_json(difference)
        return
    for word, names in (("only in the first", difference["only_a"]), ("only in the second", difference["only_b"])):
        if names:
            out.print(printable(f"{word}: {brief(names)}"), markup=False)
    alike: dict[tuple[str, str], list[str]] = {}
    for label, reasons in difference["begins"].items():
        alike.setdefault((label.partition("[")[0], "; ".join(reasons)), []).append(label)
    for (task, reason), labels in alike.items():
        where = labels[0] if len(labels) == 1 else f"{task} ×{len(labels)}"
        out.print(printable(f"starts at {where}: {reason}"), markup=False)
    changed = difference["changed"]
    out.print(f"{len(changed)} nodes have other results{': ' + brief(changed) if changed else ''}", markup=False)


def tasks(as_json: AsJson = False) -> None:
    """List every task with its inputs, output and parameters."""
    rows = [_task_row(task) for task in _pipeline().tasks.tasks]
    if as_json:
        print_json(rows)
        return
    for row in rows:
        reads = ", ".join(_read(a) for a in row["reads"]) or "the files"
        per = f" per {row['over']}" if row["over"] else ""
        named = " [dim](runs only when it is named)[/dim]" if row["on_request"] else ""
        out.print(f"[bold]{row['task']}[/bold]: {reads} → {row['writes']}{per}{named}  [dim]{escape(row['paper'])}[/dim]")
        out.print(f"    {escape(row['summary'])}")
        if row["set_by"]:
            out.print(f"    set by [cyan]{', '.join(row['set_by'])}[/cyan]")
        for name, param in row["params"].items():
            out.print(f"    [cyan]{row['task']}.{name}[/cyan] = {escape(str(param['default']))}  {escape(param['what'])}")


def _read(argument: dict[str, Any]) -> str:
    return f"{argument['artifact']}{GATHERS[argument['form']]}{' before it' if argument['previous'] else ''}"


def _task_row(task: Any) -> dict[str, Any]:
    from kinetree.pipeline.settings.sentences import sentences

    fields, texts = (task.sets.model_fields, sentences(task.sets)) if task.sets else ({}, {})
    return {
        "task": task.name,
        "over": "/".join(task.over),
        "reads": [
            {"argument": a.name, "artifact": a.artifact.__name__, "form": a.form, "previous": a.previous}
            for a in task.arguments
        ],
        "along": task.traversed,
        "writes": task.returns.__name__,
        "params": {n: {"default": f.default, "what": texts.get(n, "")} for n, f in fields.items()},
        "set_by": [f"{task.block}.{n}" for n in task.params.model_fields] if task.params not in (None, task.sets) else [],
        "on_request": task.on_request,
        "paper": task.paper,
        "summary": task.summary,
    }


def _value(content: dict[str, Any], name: str) -> str:
    if name in content.get("values", {}):
        return brief(content["values"][name])
    stats = content.get("arrays", {}).get(name)
    if stats is None:
        return ""
    if not stats["shape"]:
        return f"{stats['min']:.6g}" if "min" in stats else "not finite"
    shape = "×".join(map(str, stats["shape"]))
    return f"{shape}, {stats['min']:.6g} … {stats['max']:.6g}, mean {stats['mean']:.6g}" if "min" in stats else shape


def _pipeline(config: str | None = None, sets: list[str] | None = None) -> "Pipeline":
    """The pipeline of a configuration, or of the defaults where none is named."""
    from kinetree.pipeline.inspect import Pipeline

    return Pipeline.of(config, sets=sets or (), application=current())
