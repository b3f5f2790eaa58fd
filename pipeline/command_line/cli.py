"""The command line of an application: which commands there are, and how every refusal becomes a message and an exit code.

Nothing here imports numpy, dask or the product: commands are known by name and imported when they are called, so that help
and completion answer at once.
"""

import contextlib
import copy
import errno
import functools
import gc
import inspect
import io
import os
import sys
import textwrap
import threading
import traceback
from collections import UserDict
from collections.abc import Callable
from importlib.metadata import version
from typing import Annotated, Any, NoReturn

import typer
from typer.core import TyperCommand, TyperGroup
from typer.main import get_command

from kinetree.errors import ClusterError, ConfigError, InputError, KinetreeError, ServiceError
from kinetree.pipeline.application import Application, Command, Shortcut
from kinetree.pipeline.command_line.printable import printable
from kinetree.pipeline.running.interrupts import heed, is_interrupted
from kinetree.pipeline.settings.option import OptionSetting

EXITS = "Exit codes: 0 done · 1 nodes failed · 2 the input is wrong · 3 cluster or service failed, try again · 130 interrupted"
ENVIRONMENT = (
    errno.EACCES, errno.EPERM, errno.ENOSPC, errno.EDQUOT, errno.EROFS, errno.ENAMETOOLONG, errno.EIO, errno.EMFILE,
    errno.ENFILE, errno.ELOOP, errno.ENOTDIR, errno.ESTALE, errno.ENOMEM,
)  # fmt: skip
"""What the system refuses for reasons of its own: no error of the program."""
GARBAGE_SOUGHT_AFTER = 50_000
"""Objects made and not yet freed. After Python's 700 a run over 500 frames that computes nothing takes a fifth longer."""
THREADS = "NUMBA_NUM_THREADS"
"""Variable of the environment with which numba cannot be imported if it is wrong; other libraries pass over theirs."""


class CommandLine(TyperGroup):
    """A group that knows its commands by name and summary and imports one when it is called."""

    application: Application

    def list_commands(self, ctx: Any) -> list[str]:
        """Names in the order of the help."""
        return list(self.commands)

    def format_help(self, ctx: Any, formatter: Any) -> None:
        """The help of the whole: commands in their sections, from their summaries, nothing imported."""
        self.format_usage(ctx, formatter)
        self.format_help_text(ctx, formatter)
        width = max(map(len, self.commands), default=0)
        for section in self.application.sections:
            with formatter.section(section.title):
                formatter.write_dl([(command.name.ljust(width), command.summary) for command in section.commands])
        with formatter.section("Options"):
            formatter.write_dl([row for row in (param.get_help_record(ctx) for param in self.get_params(ctx)) if row])
        self.format_epilog(ctx, formatter)

    def shell_complete(self, ctx: Any, incomplete: str) -> list[Any]:
        """Completes names of commands, with their summaries, and options of the whole."""
        names = copy.copy(self)
        names.commands = {c.name: TyperCommand(c.name, short_help=c.summary) for c in self.application.commands.values()}
        ctx.command = names  # which typer asks for the commands, whatever `self` is
        try:
            return TyperGroup.shell_complete(names, ctx, incomplete)
        finally:
            ctx.command = self


class _Imported(UserDict[str, Any]):
    """Commands by name; taking one imports it."""

    def __init__(self, application: Application) -> None:
        super().__init__(application.commands)
        self._shortcuts = application.shortcuts

    def __getitem__(self, name: str) -> Any:
        if isinstance(self.data[name], Command):
            self.data[name] = _typer_command(self.data[name], self._shortcuts)
        return self.data[name]


def command_line(application: Application) -> CommandLine:
    """The command line of an application, as typer runs it."""
    app = typer.Typer(
        name=application.name,
        cls=CommandLine,
        help=application.summary,
        epilog=f"{application.name} COMMAND --help explains one command. {EXITS}",
        pretty_exceptions_enable=False,
    )

    @app.callback(invoke_without_command=True)
    def root(
        context: typer.Context,
        show_version: Annotated[bool, typer.Option("--version", help="Print the version and exit.")] = False,
    ) -> None:
        if show_version:
            typer.echo(version(application.name))
            raise typer.Exit
        _refuse_wrong_threads()
        if context.invoked_subcommand is None:
            _print_first_steps(application)

    group = get_command(app)
    assert isinstance(group, CommandLine)
    group.application = application
    group.commands = _Imported(application)
    return group


def main(application: Application) -> NoReturn:
    """The console script: every refusal is one message and an exit code, never a traceback.

    SIGTERM interrupts. So does SIGINT, but where this process was started to ignore it (nohup, a job in the background).
    """
    heed()
    gc.set_threshold(GARBAGE_SOUGHT_AFTER)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")  # a terminal that cannot show × must not end a run
    name = application.name
    try:
        with application.active():
            # the command returns the code of a typer.Exit
            code = int(command_line(application)(prog_name=name, standalone_mode=False) or 0)
    except (ClusterError, ServiceError) as error:
        _print_error(name, error)
        code = 3
    except InputError as error:
        _print_error(name, error)
        code = 2
    except KinetreeError as error:
        _print_error(name, error)
        code = 1
    except (KeyboardInterrupt, typer.Abort):
        code = 130
    except BrokenPipeError:
        sys.stderr.close()
        code = 141
    except Exception as error:
        # a library that could not be imported because of Ctrl-C is missed later
        code = 130 if is_interrupted() else _unexpected(name, error)
    if code == 130:
        typer.echo(f"{name}: interrupted; what is finished is kept, run again to go on", err=True)
        if threading.active_count() > 1:
            _leave(code)
    gc.freeze()  # to look for garbage when the process ends takes half a second
    raise SystemExit(code)


def _typer_command(command: Command, shortcuts: tuple[Shortcut, ...]) -> Any:
    """The imported command as typer runs it, with the application's shortcuts among its options."""
    function = command.imported()
    if command.takes_shortcuts:
        function = _with_shortcuts(function, shortcuts)
    examples = f"Example{'s' * (len(command.examples) > 1)}: {' · '.join(command.examples)}" if command.examples else ""
    epilog = "\n\n".join(filter(None, (examples.replace("[", r"\["), EXITS)))
    alone = typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode="rich")
    alone.command(name=command.name, epilog=epilog)(function)
    return get_command(alone)


def _with_shortcuts(function: Callable[..., None], shortcuts: tuple[Shortcut, ...]) -> Callable[..., None]:
    """The function with an option a shortcut; what is given there goes into `sets`, after what --set gives."""
    names = {shortcut.options[0].lstrip("-").replace("-", "_"): shortcut for shortcut in shortcuts}
    own = {name: p.replace(kind=p.KEYWORD_ONLY) for name, p in inspect.signature(function, eval_str=True).parameters.items()}
    more = {name: _parameter(name, shortcut) for name, shortcut in names.items()}

    @functools.wraps(function)
    def with_sets(**arguments: Any) -> None:
        values = [(shortcut, arguments.pop(name)) for name, shortcut in names.items()]
        sets = [OptionSetting.of(s.options[0], s.parameter, value) for s, value in values if value is not None]
        function(**{**arguments, "sets": [*(arguments["sets"] or ()), *sets]})

    parameters = [p for p in own.values() if p.name == "config"] + [*more.values()]
    parameters += [p for p in own.values() if p.name != "config"]
    with_sets.__signature__ = inspect.Signature(parameters)  # type: ignore[attr-defined]
    with_sets.__annotations__ = {p.name: p.annotation for p in parameters}
    return with_sets


def _parameter(name: str, shortcut: Shortcut) -> inspect.Parameter:
    option = typer.Option(*shortcut.options, metavar=shortcut.metavar, help=shortcut.help, show_default=False)
    return inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None, annotation=Annotated[str | None, option])


def _refuse_wrong_threads() -> None:
    """Raises ConfigError where the environment says how many threads numba may use, and that is no number from 1 on."""
    value = os.environ.get(THREADS, "").strip()
    if value and not (value.isdecimal() and int(value) > 0):
        raise ConfigError(f"{THREADS}={value}: a number of threads from 1 on is expected; unset it, or set it to 1")


def _print_first_steps(application: Application) -> None:
    typer.echo(f"{textwrap.fill(application.summary, 80)}\n\nTo begin:")
    steps = (*application.first_steps, (f"{application.name} --help", "all commands"))
    width = max(len(command) for command, _ in steps)
    for command, what in steps:
        typer.echo(f"  {command.ljust(width)}   {what}")


def _leave(code: int) -> NoReturn:
    """Ends the process though threads are in the middle of nodes, which may take minutes; the store is whole anyway."""
    for stream in (sys.stdout, sys.stderr):
        with contextlib.suppress(OSError, ValueError):
            stream.flush()
    os._exit(code)


def _unexpected(name: str, error: Exception) -> int:
    """Click's own refusals of options and arguments, and errors that are ours."""
    format_message = getattr(error, "format_message", None)
    if format_message is not None:
        _complain(f"{name}: {printable(format_message())}\nTry {name} --help")
        return 2
    if isinstance(error, OSError) and error.errno in ENVIRONMENT:
        _complain(f"{name}: {printable(error.filename or 'the system')}: {error.strerror}")
        return 2
    traceback.print_exception(error)
    _complain(f"{name}: this is an error in {name} itself; the store is whole. Please report it with the lines above.")
    return 1


def _print_error(name: str, error: KinetreeError) -> None:
    lines = isinstance(error, ConfigError)  # one line a key; elsewhere a line end is part of somebody's file name
    _complain(f"{name}: {printable(error, lines=lines)}")


def _complain(text: str) -> None:
    typer.secho(text, err=True, fg=typer.colors.RED)
