"""`artifact("task")` as a type checker sees it: the class that the task of that name writes."""

from collections.abc import Callable
from typing import TYPE_CHECKING, cast

from kinetree.schemas.array import Artifact

if TYPE_CHECKING:  # the one place where the loom names what the product stores; nothing of it exists when a program runs
    from kinetree.schemas.artifact_of_task import ArtifactOfTask


def typed_by_name(method: Callable[..., Artifact]) -> "ArtifactOfTask":
    """The method itself, whose result has the type of the class or of the task's name that it is called with."""
    return cast("ArtifactOfTask", method)
