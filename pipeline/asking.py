"""The commands that read: what there is, what is stale and why, from what it was made."""

from typing import Annotated, Any

import typer
from rich.markup import escape
from rich.table import Table

from kinetree.errors import ConfigError
from kinetree.pipeline.draw import Format, draw
from kinetree.pipeline.explain import explained
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.options import AsJson, Set, Target, brief, here, out, pipeline_of, print_json
from kinetree.pipeline.printable import printable
from kinetree.pipeline.show import shown

GATHERS = {"one": "", "tuple": " of all", "mapping": " of all"}


def register(app: typer.Typer) -> None:
    """Adds the commands to the command line."""
    app.command(name="config", epilog="Examples: kinetree config > walk.yaml · kinetree config paper-2014")(config_)
    app.command(epilog=escape('Examples: kinetree why "mesh[frame=3]" walk/ · kinetree why leaves walk/'))(why)
    app.command(epilog="Examples: kinetree graph · kinetree graph walk/ --format dot | dot -Tsvg > graph.svg")(graph)
    app.command(epilog=escape('Example: kinetree show "mesh[frame=3]" walk/'))(show)
    app.command(epilog="Example: kinetree runs walk/")(runs)
    app.command(epilog="Example: kinetree diff 20250301-081500-123ab 20250302-081500-4560c walk/")(diff)
    app.command(epilog="Example: kinetree tasks --json")(tasks)


def config_(config: Target = None, sets: Set = None, as_json: AsJson = False) -> None:
    """Print the whole configuration as YAML, every parameter with its value and what it means."""
    pipeline = Pipeline.of(config, sets=sets or ())
    if as_json:
        params = {name: block.model_dump(mode="json") for name, block in pipeline.config.params.items()}
        print_json({"method": pipeline.config.method, **params})
        return
    typer.echo(explained(pipeline.config, pipeline.tasks), nl=False)


def why(node: Annotated[str, typer.Argument(help=escape("A node, e.g. mesh[frame=3] or connectivity."))], config: Target = None,
        sets: Set = None, as_json: AsJson = False) -> None:  # fmt: skip
    """Say why one node is fresh, stale or waiting, and what it is made from."""
    pipeline = pipeline_of(config, sets=sets)
    planned = pipeline.why(node)
    lineage = pipeline.lineage(node)
    reads, feeds = sorted(lineage.predecessors(planned.node)), sorted(lineage.successors(planned.node))
    if as_json:
        print_json({"node": planned.node, "state": planned.state, "waits": list(planned.waits),
                     "reasons": [{"kind": r.kind, "what": r.what} for r in planned.reasons],
                     "reads": reads, "feeds": feeds})  # fmt: skip
        return
    out.print(printable(planned), markup=False)
    for word, names in (("reads", reads), ("feeds", feeds)):
        if names:
            more = f" and {len(names) - 8} more" if len(names) > 8 else ""
            out.print(printable(f"  {word} {', '.join(names[:8])}{more}"), markup=False)


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
    target = config if config is not None else here()
    if target is None and expanded:
        raise ConfigError("--expanded draws the nodes of a sequence; name a config or an output folder")
    drawn = Pipeline.of().tasks.networkx() if target is None else Pipeline.of(target).graph(expanded=expanded)
    typer.echo(draw(drawn, chosen))


def show(node: Annotated[str, typer.Argument(help=escape("A node, e.g. mesh[frame=3]."))], config: Target = None,
         sets: Set = None, as_json: AsJson = False) -> None:  # fmt: skip
    """Show what a node holds: schema, shapes, statistics, and how it was made."""
    told = shown(pipeline_of(config, sets=sets), node)
    if as_json:
        print_json(told)
        return
    out.print(printable(told["why"]), markup=False)
    for line in (*told["told"], "") if told.get("told") else ():
        out.print(printable(line), markup=False)
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("field", "type", "value", "what"):
        table.add_column(name, overflow="fold")
    for name, field in told["schema"]["fields"].items():
        table.add_row(name, escape(field["type"]), escape(printable(_value(told, name))), escape(field["what"]))
    out.print(table)
    for name, value in (told.get("made") or {}).items():
        out.print(printable(f"{name}: {brief(value)}"), markup=False)


def runs(config: Target = None, as_json: AsJson = False) -> None:
    """List the runs on record in the store, oldest first."""
    found = pipeline_of(config).runs()
    if as_json:
        print_json(found)
        return
    table = Table(box=None, pad_edge=False, header_style="bold")
    for name in ("run", "status", "ran", "fresh", "failed", "seconds", "output"):
        table.add_column(name, overflow="fold")
    for row in found:
        told = [str(row.get("counts", {}).get(name, "")) for name in ("ran", "fresh", "failed")]
        fields = [row["name"], row["status"], *told, row.get("seconds", ""), row["output"]]
        table.add_row(*(escape(printable(field)) for field in fields))
    out.print(table)


def diff(run_a: Annotated[str, typer.Argument(help="A run, as kinetree runs names it.")],
         run_b: Annotated[str, typer.Argument(help="Another run.")], config: Target = None,
         as_json: AsJson = False) -> None:  # fmt: skip
    """Say what differs between two runs, and from where."""
    told = pipeline_of(config).diff(run_a, run_b)
    if as_json:
        print_json(told)
        return
    for word, names in (("only in the first", told["only_a"]), ("only in the second", told["only_b"])):
        if names:
            out.print(printable(f"{word}: {brief(names)}"), markup=False)
    alike: dict[tuple[str, str], list[str]] = {}
    for label, reasons in told["begins"].items():
        alike.setdefault((label.partition("[")[0], "; ".join(reasons)), []).append(label)
    for (task, why_), labels in alike.items():
        out.print(printable(f"begins at {labels[0] if len(labels) == 1 else f'{task} ×{len(labels)}'}: {why_}"), markup=False)
    out.print(f"{len(told['changed'])} nodes have other results{': ' + brief(told['changed']) if told['changed'] else ''}",
              markup=False)  # fmt: skip


def tasks(as_json: AsJson = False) -> None:
    """The table of contents: each task with its inputs, output, parameters and the paper's section."""
    rows = [_task_row(task) for task in Pipeline.of().tasks.tasks]
    if as_json:
        print_json(rows)
        return
    for row in rows:
        reads = ", ".join(_read(a) for a in row["reads"]) or "the files"
        per = f" per {row['over']}" if row["over"] else ""
        named = " [dim](only when it is named)[/dim]" if row["on_request"] else ""
        out.print(f"[bold]{row['task']}[/bold]: {reads} → {row['writes']}{per}{named}  [dim]{escape(row['paper'])}[/dim]")
        out.print(f"    {escape(row['summary'])}")
        for name, param in row["params"].items():
            out.print(f"    [cyan]{row['task']}.{name}[/cyan] = {escape(str(param['default']))}  {escape(param['what'])}")


def _read(argument: dict[str, Any]) -> str:
    return f"{argument['artifact']}{GATHERS[argument['form']]}{' before it' if argument['previous'] else ''}"


def _task_row(task: Any) -> dict[str, Any]:
    fields = task.params.model_fields if task.params else {}
    return {
        "task": task.name,
        "over": "/".join(task.over),
        "reads": [
            {"argument": a.name, "artifact": a.artifact.__name__, "form": a.form, "previous": a.previous}
            for a in task.arguments
        ],
        "along": task.traversed,
        "writes": task.returns.__name__,
        "params": {n: {"default": f.default, "what": f.description or ""} for n, f in fields.items()},
        "on_request": task.on_request,
        "paper": task.paper,
        "summary": task.summary,
    }


def _value(told: dict[str, Any], name: str) -> str:
    if name in told.get("values", {}):
        return brief(told["values"][name])
    stats = told.get("arrays", {}).get(name)
    if stats is None:
        return ""
    shape = "×".join(map(str, stats["shape"]))
    return f"{shape}, {stats['min']:.6g} … {stats['max']:.6g}, mean {stats['mean']:.6g}" if "min" in stats else shape
