"""What a run leaves in its output folder: what artifacts hold for other programs, run.json, the configuration."""

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import yaml

from kinetree.pipeline.blocks import SAVED
from kinetree.pipeline.config import Config
from kinetree.pipeline.errors import ConfigError, DamagedArtifactError, StoreError
from kinetree.pipeline.place import Folder
from kinetree.pipeline.schedule import DONE, Entry, Schedule
from kinetree.schemas.array import Artifact

RUN_JSON = "run.json"


def write_config(config: Config) -> None:
    """Leaves the configuration, so that every command can name the output folder instead of the file."""
    head = "# The configuration of the last run into this folder; what is not here is the default.\n"
    _write(config.output, SAVED, head + as_yaml(config.saved()))


def as_yaml(saved: dict[str, Any]) -> str:
    """YAML that is read back as the same: in the user's own letters, or in escapes where a line separator is among them."""
    text = yaml.safe_dump(saved, sort_keys=False, allow_unicode=True)
    return text if yaml.safe_load(text) == saved else yaml.safe_dump(saved, sort_keys=False)


def write_run_json(config: Config, told: dict[str, Any]) -> None:
    """Leaves what ran, what was fresh, what failed."""
    _write(config.output, RUN_JSON, json.dumps(told, indent=2, ensure_ascii=False) + "\n")


def write_results(folder: Path, schedule: Schedule) -> list[str]:
    """Leaves the files and groups of every artifact that has some, each whole or not at all; returns their names.

    One that lies there with the same bytes is not touched.
    raises : StoreError where the folder cannot be written; DamagedArtifactError, after which a run makes it again
    """
    left: list[str] = []
    for entry in schedule.entries.values():
        if entry.state in DONE and entry.artifact is not None and leaves(entry.task.returns):
            try:
                left += write_result(folder, schedule, entry)
            except DamagedArtifactError:
                schedule.store.discard(entry.artifact)
                raise
    return left


def write_result(folder: Path, schedule: Schedule, entry: Entry) -> list[str]:
    """Leaves the files and the group of one node that has its artifact; see `write_results`."""
    place, name = Folder(folder, "output folder", beside=""), entry.task.returns.left_as
    files = schedule.value(entry.node).files(entry.node.at)
    for path, data in files.items():
        if place.size(path) != len(data) or place.get(path) != data:
            place.put(path, data)
    if name:
        _put_group(place, name, schedule.store.group(str(entry.artifact)))
    return [*files, *([name] if name else [])]


def write_elsewhere(path: Path, schedule: Schedule, task: str) -> list[Path]:
    """Leaves what one task's artifacts leave at a path of the user's: one file or group is named so, several lie in it.

    raises : as `write_results`; ConfigError where that would overwrite what the sequence is read from
    """
    done = [e for e in schedule.entries.values() if e.node.task == task and e.artifact is not None]
    files = {name: data for e in done for name, data in schedule.value(e.node).files(e.node.at).items()}
    names = {name: name.rpartition("/")[2] for name in files}
    group = done[0].task.returns.left_as if done else ""
    is_folder = path.is_dir() and not group
    targets = {name: path / short if is_folder or len(files) > 1 else path for name, short in names.items()}
    _refuse_input([*targets.values(), *([path] if group else [])], schedule)
    for name, target in targets.items():
        Folder(target.parent, "output folder", beside="").put(target.name, files[name])
    if group:
        _put_group(Folder(path.parent, "output folder", beside=""), path.name, schedule.store.group(str(done[0].artifact)))
    return [*targets.values(), *([path] if group else [])]


def leaves(cls: type[Artifact]) -> bool:
    """Whether artifacts of this class leave anything in an output folder."""
    return bool(cls.left_as) or cls.files is not Artifact.files


def _put_group(place: Folder, name: str, files: Mapping[str, bytes]) -> None:
    """A group's attributes hold the digests of its arrays: where they and all sizes agree, so does the rest."""
    sizes = {path: len(data) for path, data in files.items()}
    if place.get(f"{name}/zarr.json") != files["zarr.json"] or place.tree(name) != sizes:
        if place.tree(name) and place.size(f"{name}/zarr.json") is None:
            raise StoreError(f"output folder {place.url}: {name} is there and no zarr group; remove it or name another")
        place.remove(name)
        place.put_all(name, files)


def _refuse_input(targets: list[Path], schedule: Schedule) -> None:
    """What the sequence is read from is the user's own and may be all there is."""
    found = [artifact for given in schedule.given.values() for artifact in given.values()]
    places = {Path(str(getattr(a, name))).absolute() for a in found for name in a.location_fields() if name == "path"}
    for target in targets:
        if target.absolute() in places:
            raise ConfigError(f"{target}: the sequence is read from it; name another place with --output")


def _write(folder: Path, name: str, text: str) -> None:
    Folder(folder, "output folder", beside="").put(name, text.encode("utf-8", "backslashreplace"))
