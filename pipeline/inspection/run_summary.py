"""What a run says of itself when it is over."""

from collections.abc import Mapping
from typing import Any

from kinetree.pipeline.inspection.snapshot import Snapshot


class RunSummary(dict[str, Any]):
    """The content of run.json and the run's name; shown as one line and its failures."""

    def __init__(self, content: Mapping[str, Any], there: Snapshot) -> None:
        """`there` is what the run left, to be asked for artifacts and remarks without a new look at the store."""
        super().__init__(content)
        self.there = there

    def __reduce__(self) -> tuple[type, tuple[dict[str, Any]]]:
        """Travels as the plain content: what the run left belongs to this process."""
        return dict, (dict(self),)

    def __repr__(self) -> str:
        counts = ", ".join(f"{count} {name}" for name, count in self["nodes"].items() if count or name in ("ran", "fresh"))
        lines = [f"{self['run']} {self['status']}: {counts} in {self['seconds']:.1f} s"]
        return "\n".join(lines + [f"  {f['node']}: {f['error']}: {f['message']}" for f in self["failures"]])
