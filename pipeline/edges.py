"""The edges that signatures draw between tasks: who writes what, who reads whom, over which members an argument gathers."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from kinetree.errors import GraphError, UnknownNodeError
from kinetree.pipeline.signature import Argument
from kinetree.pipeline.suggest import nearest
from kinetree.pipeline.task import Space, Task, space
from kinetree.schemas.array import Artifact

AnyTask = Task[..., Any]


@dataclass(frozen=True)
class Edges:
    """Tasks and what their signatures say of each other; whether that can work is the graph's to check."""

    tasks: tuple[AnyTask, ...]
    renamed: Mapping[str, str] = field(default_factory=dict, compare=False, repr=False)
    """What tasks of earlier versions are called now; what refuses the old name says so."""

    @cached_property
    def by_name(self) -> dict[str, AnyTask]:
        """Tasks by name."""
        return {task.name: task for task in self.tasks}

    @cached_property
    def writers(self) -> dict[type[Artifact], AnyTask]:
        """The task that writes each artifact class."""
        return {task.returns: task for task in self.tasks}

    @cached_property
    def openers(self) -> dict[Space, AnyTask]:
        """The task whose artifact lists the members of each space's last dimension."""
        by_space = {task.over: task for task in self.tasks if lists_members(task)}
        by_space.update({space(path): task for task in self.tasks for path in task.returns.opens})
        return by_space

    def task(self, name: str) -> AnyTask:
        """The task of that name; raises UnknownNodeError with its new name or the nearest one."""
        if name not in self.by_name:
            new_name = self.renamed.get(name, "")
            instead = f"it is now {new_name!r}" if new_name in self.by_name else nearest(name, self.by_name)
            raise UnknownNodeError(f"no task {name!r}; {instead}")
        return self.by_name[name]

    def writer(self, what: type[Artifact] | str) -> AnyTask:
        """The task of that name or the one that writes that artifact class; raises UnknownNodeError."""
        if isinstance(what, str):
            return self.task(what)
        if not isinstance(what, type):
            raise UnknownNodeError(f"expected an artifact's class or a task's name, got {what!r}")
        if what not in self.writers:
            raise UnknownNodeError(f"no task of this graph writes {what.__name__}")
        return self.writers[what]

    def reads(self, task: AnyTask) -> tuple[AnyTask, ...]:
        """Tasks without which this one cannot run or even be laid out, itself left out."""
        return tuple(dict.fromkeys((*self.before(task), *self.behind(task))))

    def before(self, task: AnyTask) -> tuple[AnyTask, ...]:
        """Tasks that come before this one: what it reads at its own index, and what tells indices, traversal and selection."""
        earlier = [self.writers[a.artifact] for a in task.arguments if not a.previous]
        earlier += [self.openers[s] for s in self.needed_spaces(task)]
        if task.along is not None:
            earlier.append(self.writers[task.along])
        if task.among is not None:
            earlier.append(self.writers[task.among])
        return tuple(dict.fromkeys(t for t in earlier if t is not task))

    def behind(self, task: AnyTask) -> tuple[AnyTask, ...]:
        """Other tasks that this one reads at the previous member of its traversal; they may read this one in turn."""
        writers = [self.writers[a.artifact] for a in task.arguments if a.previous]
        return tuple(dict.fromkeys(t for t in writers if t is not task))

    def needed_spaces(self, task: AnyTask) -> tuple[Space, ...]:
        """The spaces whose members must be listed for this task, with all prefixes: its own, those it gathers over, and
        those of the tasks it reads at the previous member.
        """
        wanted = [task.over, *(self.gathered_space(task, a) for a in task.arguments if a.form != "one")]
        wanted += [writer.over for writer in self.behind(task)]
        return tuple(dict.fromkeys(s[:depth] for s in wanted for depth in range(1, len(s) + 1)))

    def gathered_space(self, task: AnyTask, argument: Argument) -> Space:
        """The space over which an argument is read: frames *of this interval* where such a space is opened, else all."""
        writer = self.writers[argument.artifact]
        gathered = self._gathered_space(task, argument, writer)
        if argument.previous and task.traversed not in gathered:
            per = f"per {'/'.join(writer.over)}" if writer.over else "once"
            raise GraphError(
                f"{task.name} ({task.where}): argument {argument.name} is read at the previous {task.traversed}, but"
                f" {writer.name} ({writer.where}) writes {argument.artifact.__name__} {per}"
            )
        return gathered

    def numbered(self, task: AnyTask, argument: Argument) -> int:
        """The position, in the index of what a mapping gathers, of the member number that is its key."""
        over = self.writers[argument.artifact].over
        return next(n for n, dim in enumerate(over) if dim not in task.over)

    def _gathered_space(self, task: AnyTask, argument: Argument, writer: AnyTask) -> Space:
        missing = tuple(d for d in writer.over if d not in task.over)
        place = f"{task.name} ({task.where}): argument {argument.name}"
        if argument.form == "one":
            if missing:
                raise GraphError(
                    f"{place} is one {argument.artifact.__name__}, but {writer.name} ({writer.where}) writes one per"
                    f" {'/'.join(writer.over)}; write tuple[{argument.artifact.__name__}, ...] to gather them"
                )
            return writer.over
        if not missing:
            raise GraphError(f"{place} gathers {argument.artifact.__name__}, of which there is one at its index")
        if argument.form == "mapping" and len(missing) != 1:
            raise GraphError(f"{place} maps from one number, but gathers over {'/'.join(missing)}; use a tuple")
        joint = task.over + missing
        if joint in self.openers:
            return joint
        if writer.over not in self.openers:
            raise GraphError(f"{place} gathers over {'/'.join(writer.over)}, which nothing opens")
        return writer.over


def lists_members(task: AnyTask) -> bool:
    """Whether the members that a task finds outside are the fan-out of its dimension."""
    return task.is_origin and bool(task.over) and not task.is_linked
