"""The product on the loom: `methods` is the table of contents, `application` the command line, `commands` what it offers."""

if __name__ != "kinetree.tasks":
    raise ImportError(f"import kinetree.tasks, not {__name__}: the top-level folders are not packages of their own")

from typing import TYPE_CHECKING, Any

from kinetree.pipeline.views import provide

if TYPE_CHECKING:
    from kinetree.tasks.methods import METHODS

__all__ = ["METHODS", "VIEWS"]
VIEWS = tuple(
    f"kinetree.tasks.views.{shelf}"
    for shelf in ("input", "topology", "registration", "structure", "paper_2014", "paper_2009", "results", "verdict")
)
"""What people see of results, a module a shelf and one for the verdict; each is imported when somebody looks."""
provide(*VIEWS)


def __getattr__(name: str) -> Any:
    """Imports the tasks when the methods are asked for: the help of the command line does without them."""
    if name == "METHODS":
        from kinetree.tasks.methods import METHODS

        return METHODS
    raise AttributeError(f"kinetree.tasks has no {name}")
