"""What the command line offers beside the loom: commands that speak of bodies and not of graphs, one file each."""

import typer

from kinetree.tasks.commands import evaluate, export, plot, synth, view


def register(app: typer.Typer) -> None:
    """Adds the commands to the command line."""
    for module in (synth, evaluate, export, plot, view):
        module.register(app)
