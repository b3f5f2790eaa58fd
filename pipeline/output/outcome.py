"""What became of one sequence of a data set: a file in its output folder that the next run, a plan and a status read."""

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.storage.place import Folder

OUTCOME = "outcome.json"
FORMAT = "kinetree.outcome/1"
Ending = Literal["done", "failed", "interrupted", "stopped"]


@dataclass(frozen=True)
class Outcome:
    """One sequence as its last run left it."""

    name: str
    input: str
    status: Ending
    ended: str
    """When, in UTC."""
    run: str = ""
    """The run's name in the store; empty where the input was refused before anything ran."""
    seconds: float = 0.0
    """Seconds of computing of all nodes there are, whichever run computed them."""
    members: int = 0
    """What the input consists of, as its origins list it."""
    nodes: Mapping[str, int] = field(default_factory=dict)
    failures: tuple[Mapping[str, str], ...] = ()
    remarks: tuple[str, ...] = ()
    """What its results have to say."""
    mark: str = ""
    """Digest of the parameters, code and input that it was made of."""
    artifacts: Mapping[str, str] = field(default_factory=dict)
    """Digests, by task, of what the data set's summary reads."""
    files: Mapping[str, tuple[int, int]] = field(default_factory=dict)
    """What it left in its output folder, with size and time of the last change."""

    @property
    def is_done(self) -> bool:
        """Whether everything was computed."""
        return self.status == "done"

    @staticmethod
    def at(folder: Path) -> "Outcome | None":
        """The one in an output folder; None where there is none or it cannot be read."""
        try:
            fields = json.loads((folder / OUTCOME).read_text(encoding="utf-8"))
            if fields.pop("format") != FORMAT:
                return None
            files: Any = {name: (int(size), int(when)) for name, (size, when) in fields.pop("files").items()}
            lists: dict[str, Any] = {key: tuple(fields.pop(key)) for key in ("failures", "remarks")}
            return Outcome(**fields, **lists, files=files)
        except (OSError, ValueError, TypeError, KeyError, AttributeError):
            return None

    def write(self, folder: Path) -> None:
        """Leaves it in an output folder; raises StoreError."""
        text = json.dumps({"format": FORMAT, **asdict(self)}, indent=2, ensure_ascii=False)
        Folder(folder, "output folder", beside="").put(OUTCOME, f"{text}\n".encode("utf-8", "backslashreplace"))

    def is_untouched(self, folder: Path) -> bool:
        """Whether everything it left is still as it left it."""
        return stamps(folder, self.files) == dict(self.files)


def stamps(folder: Path, names: Any) -> dict[str, tuple[int, int]]:
    """Size and time of the last change of files, and of folders with all that is in them, by name; without missing ones."""
    by_name: dict[str, tuple[int, int]] = {}
    for name in names:
        path = folder / name
        inside = sorted(path.rglob("*")) if path.is_dir() else [path]
        try:
            stats = [file.stat() for file in inside if not file.is_dir()]
        except OSError:
            continue
        if stats:
            by_name[name] = sum(s.st_size for s in stats), max(s.st_mtime_ns for s in stats)
    return by_name


def computing_seconds(schedule: Schedule) -> float:
    """Seconds that the nodes which have a result took, each once, whichever run computed it."""
    done: list[Entry] = [e for e in schedule.entries.values() if e.state in DONE and e.record is not None]
    return round(sum(e.record.seconds for e in done if e.record is not None), 3)
