"""The loom of kinetree; `from kinetree.pipeline import Pipeline` is how a program uses it."""

if __name__ != "kinetree.pipeline":
    raise ImportError(f"import kinetree.pipeline, not {__name__}: the top-level folders are not packages of their own")

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kinetree.pipeline.inspect import Pipeline

__all__ = ["Pipeline"]


def __getattr__(name: str) -> Any:
    """Imports the pipeline when it is asked for: schemas and numerics need its errors alone."""
    if name == "Pipeline":
        from kinetree.pipeline.inspect import Pipeline

        return Pipeline
    raise AttributeError(f"kinetree.pipeline has no {name}")
