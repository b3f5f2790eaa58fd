"""Whose the files of an output folder are: what another program or a person put there is never replaced."""

import json
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from kinetree.errors import StoreError
from kinetree.pipeline.settings.blocks import SAVED
from kinetree.pipeline.storage.place import Folder

MARKER = ".files.json"
"""Lists what runs have left in the folder it lies in."""
HEAD = "# The configuration of the last run into this folder; what is not here is the default.\n"
"""First line of the configuration that a run leaves; a folder that has it is an output folder, also where the list was lost."""


@dataclass(eq=False)
class Owned:
    """The names directly in an output folder that runs have left there, or are about to."""

    folder: Path
    names: set[str] | None
    """None where all that is there is a run's: the folder was copied without its list."""

    @staticmethod
    def of(folder: Path) -> "Owned":
        """What is known of a folder, which need not exist."""
        listed = _listed(folder)
        if listed is None and not (_place(folder).get(SAVED) or b"").startswith(HEAD.encode()):
            listed = set()
        return Owned(folder, listed)

    def claim(self, paths: Iterable[str]) -> None:
        """Lists what a run is about to write, so that the next run knows it again even if this one is killed.

        paths  : relative to the folder; what lies in a folder in it is listed by that folder
        raises : StoreError where the folder is a file or something is there that no run has left, where a path does not lie in
                 it, or where the list cannot be written
        """
        if self.folder.is_file():
            raise StoreError(f"output folder {self.folder}: this is a file; name another folder with --output")
        wanted = {path.partition("/")[0] for path in self._inside(paths)}
        was_lost = self.names is None
        if self.names is None:
            self.names = {name for name in _place(self.folder).names("") if not name.startswith(".")}
        else:
            self.names |= _listed(self.folder) or set()  # another run into this folder may be under way
        new = sorted(wanted - self.names)
        foreign = [name for name in new if (self.folder / name).exists() or (self.folder / name).is_symlink()]
        if foreign:
            named = " and ".join([*filter(None, [", ".join(foreign[:-1])]), foreign[-1]])
            raise StoreError(
                f"output folder {self.folder}: no run has left {named} there, and a run would replace what is;"
                " move it away or name another folder with --output; what is computed is kept"
            )
        if new or was_lost:
            self.names.update(new)
            _place(self.folder).put(MARKER, json.dumps({"files": sorted(self.names)}, indent=1).encode())

    def _inside(self, paths: Iterable[str]) -> Iterator[str]:
        for path in paths:
            _place(self.folder).refuse_outside(path)
            yield path


def _listed(folder: Path) -> set[str] | None:
    """What the folder's list has now; None where there is none that can be read."""
    try:
        return {str(name) for name in json.loads(_place(folder).get(MARKER) or b"")["files"]}
    except (ValueError, KeyError, TypeError):
        return None


def _place(folder: Path) -> Folder:
    return Folder(folder, "output folder", beside="")
