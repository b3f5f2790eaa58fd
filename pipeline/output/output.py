"""What a run leaves in its output folder: what artifacts hold for other programs, run.json, the configuration."""

import contextlib
import json
from collections.abc import Collection, Iterator, Mapping
from pathlib import Path, PurePath
from typing import Any

from kinetree.errors import ConfigError, DamagedArtifactError, StoreError
from kinetree.pipeline import views
from kinetree.pipeline.output.ownership import HEAD, MARKER, Owned
from kinetree.pipeline.planning.entry import DONE, Entry
from kinetree.pipeline.planning.schedule import Schedule
from kinetree.pipeline.settings.blocks import SAVED
from kinetree.pipeline.settings.config import Config
from kinetree.pipeline.settings.yaml_text import dumped, parsed
from kinetree.pipeline.storage.place import Folder
from kinetree.schemas.array import Artifact

RUN_JSON = "run.json"
_OF_THE_RUN = frozenset([SAVED, RUN_JSON, MARKER])
"""What a run leaves of itself; no result replaces it."""


def write_config(config: Config) -> None:
    """Leaves the configuration, so that every command can name the output folder instead of the file."""
    _write(config.output, SAVED, HEAD + as_yaml(config.portable()))


def as_yaml(saved: dict[str, Any]) -> str:
    """YAML that is read back as the same: in the user's own letters, or in escapes where a line separator is among them."""
    text = dumped(saved, sort_keys=False, allow_unicode=True)
    return text if parsed(text, "") == saved else dumped(saved, sort_keys=False)


def write_run_json(config: Config, summed: dict[str, Any]) -> None:
    """Leaves what ran, what was fresh, what failed."""
    _write(config.output, RUN_JSON, json.dumps(summed, indent=2, ensure_ascii=False) + "\n")


def claim(config: Config, schedule: Schedule, always: Collection[str]) -> Owned:
    """The output folder, if nothing is in the way of what a run leaves whatever it computes; raises StoreError.

    always : what it leaves beside groups and pages
    """
    owned = Owned.of(config.output)
    classes = [entry.task.returns for entry in schedule.entries.values()]
    names = [name for cls in dict.fromkeys(classes) for name in (views.group_name(cls), views.page_name(cls)) if name]
    owned.claim((*always, *names))
    return owned


def summaries(schedule: Schedule) -> dict[str, Any]:
    """What run.json says of results that stand for the whole sequence, by task; one that is damaged is removed and left out."""
    by_task: dict[str, Any] = {}
    for entry in schedule.entries.values():
        if entry.state in DONE and not entry.task.over and views.has_summary(entry.task.returns):
            with contextlib.suppress(DamagedArtifactError), _damage_discarded(schedule, entry):
                by_task[entry.task.name] = views.summary(schedule.value(entry.node))
    return by_task


def write_results(owned: Owned, schedule: Schedule) -> list[str]:
    """Leaves the files and groups of every artifact that has some, each whole or not at all; returns their names.

    What other graphs' runs made lies in folders of theirs. One that lies there with the same bytes is not touched.
    raises : StoreError where the folder cannot be written or has such a file of somebody else's; DamagedArtifactError, after
             which a run makes it again
    """
    done = [e for e in schedule.entries.values() if e.state in DONE and not e.task.is_linked and leaves(e.task.returns)]
    return [name for entry in done for name in write_result(owned, schedule, entry)]


def write_pages(folder: Path, schedule: Schedule, run: Mapping[str, Any]) -> None:
    """Leaves the files that also describe the run itself; raises as `write_results`."""
    for entry in schedule.entries.values():
        name = views.page_name(entry.task.returns)
        if entry.state in DONE and name:
            with _damage_discarded(schedule, entry):
                data = views.page(schedule.value(entry.node), run)
            Folder(folder, "output folder", beside="").put(name, data)


def pages(schedule: Schedule) -> list[str]:
    """The names of the files that `write_pages` leaves."""
    done = [views.page_name(e.task.returns) for e in schedule.entries.values() if e.state in DONE]
    return [name for name in done if name]


def write_result(owned: Owned, schedule: Schedule, entry: Entry) -> list[str]:
    """Leaves the files and the group of one node that is done; see `write_results`."""
    place, name = Folder(owned.folder, "output folder", beside=""), views.group_name(entry.task.returns)
    files = _files(schedule, entry)
    owned.claim([*files, *([name] if name else [])])
    for path, data in files.items():
        if place.size(path) != len(data) or place.get(path) != data:
            place.put(path, data)
    if name:
        _put_group(place, name, schedule, entry)
    return [*files, *([name] if name else [])]


def write_elsewhere(
    path: Path, schedule: Schedule, task: str, inputs: Collection[str] = (), endings: Collection[str] | None = None
) -> list[Path]:
    """Leaves what one task's artifacts leave at a path of the user's: one file or group is named so, several lie in it.

    inputs  : endings of files, such as ".txt", all of which are read from a folder that is the input
    endings : that a single file may have; None: that of the file in the run's own folder
    raises  : as `write_results`; ConfigError where that would overwrite or join what the input is read from, or a device, or
              name a file as another kind of files is named
    """
    if path.exists() and not (path.is_file() or path.is_dir()):
        raise ConfigError(f"{path}: neither a file nor a folder, and would be overwritten; name another path with --output")
    done = [e for e in schedule.entries.values() if e.node.task == task and e.state in DONE]
    files = {name.rpartition("/")[2]: data for e in done for name, data in _files(schedule, e).items()}
    beside = Folder(path.parent, "output folder", beside="")
    if groups := [name for e in done if (name := views.group_name(e.task.returns))]:
        _refuse_input(path, [], schedule, inputs)
        refuse_ending(path, endings or [PurePath(groups[0]).suffix])
        _put_group(beside, path.name, schedule, done[0])
        return [path]
    is_folder = path.is_dir() or len(files) > 1
    targets = [path / name for name in files] if is_folder else [path]
    _refuse_input(path, targets, schedule, inputs)
    if not is_folder:
        refuse_ending(path, endings or [PurePath(name).suffix for name in files])
    if is_folder and not path.exists():
        beside.put_all(path.name, files)
    else:
        for target, data in zip(targets, files.values(), strict=True):
            Folder(target.parent, "output folder", beside="").put(target.name, data)
    return targets


def refuse_ending(path: Path, endings: Collection[str]) -> None:
    """A file that ends as another kind misleads programs, and one that lies there is another program's.

    endings : that the kind has, such as ".txt"; no ending at all is as good where nothing lies there, or a folder
    raises  : ConfigError
    """
    if path.suffix.lower() not in endings and (path.suffix or path.is_file()):
        *others, last = endings
        named = f"{', '.join(others)} or {last}" if others else last
        raise ConfigError(f"{path}: what is written there ends in {named}; name it so")


def leaves(cls: type[Artifact]) -> bool:
    """Whether artifacts of this class leave anything in an output folder."""
    return bool(views.group_name(cls)) or views.leaves_files(cls)


def _files(schedule: Schedule, entry: Entry) -> Mapping[str, bytes]:
    with _damage_discarded(schedule, entry):
        files = views.files(schedule.value(entry.node), entry.node.at)
        for name in files:
            if name.partition("/")[0] in _OF_THE_RUN:
                raise DamagedArtifactError(str(entry.artifact), f"names a file {name!r}, which belongs to the run")
        return files


def _put_group(place: Folder, name: str, schedule: Schedule, entry: Entry) -> None:
    """Leaves a group as a folder; one that lies there with the same bytes is not touched."""
    with _damage_discarded(schedule, entry):
        files = schedule.store.group(entry.task.returns, str(entry.artifact))
    there = place.listed(name)
    if set(there) == set(files) and all(place.get(f"{name}/{path}") == data for path, data in files.items()):
        return
    is_ours = _attributes(place.get(f"{name}/zarr.json")).get("schema") == entry.task.returns.__name__
    if there and not is_ours and set(there) != set(files):
        raise StoreError(f"output folder {place.url}: {name} was written by another program; remove it or name another path")
    place.remove(name)
    place.put_all(name, files)


def _attributes(data: bytes | None) -> dict[str, Any]:
    """What kinetree wrote into a group's metadata; empty where it did not."""
    try:
        return dict(json.loads(data or b"")["attributes"]["kinetree"])
    except (ValueError, KeyError, TypeError):
        return {}


@contextlib.contextmanager
def _damage_discarded(schedule: Schedule, entry: Entry) -> Iterator[None]:
    """What cannot be read is removed, so that the next run makes it again."""
    try:
        yield
    except DamagedArtifactError:
        schedule.store.discard(str(entry.artifact))
        raise


def _refuse_input(path: Path, targets: list[Path], schedule: Schedule, inputs: Collection[str]) -> None:
    """What the input is read from is the user's own and may be all there is; targets are the files that lie at the path."""
    origins = [artifact for members in schedule.origin_artifacts.values() for artifact in members.values()]
    places = {Path(str(getattr(a, name))).resolve() for a in origins for name in a.location_fields() if name == "path"}
    if len(targets) > 1 and sum(place.parent == path.resolve() for place in places) > 1:
        raise ConfigError(f"{path}: the input is the files in this folder; name another with --output")
    for target in (path, *targets):
        beside = sum(place.parent == target.resolve().parent for place in places)
        if target.resolve() in places:
            raise ConfigError(f"{target}: the input is read from it; name another path with --output")
        if beside > 1 and target.suffix.lower() in inputs:
            raise ConfigError(f"{target}: the input is all files of this kind in this folder; name another with --output")


def _write(folder: Path, name: str, text: str) -> None:
    Folder(folder, "output folder", beside="").put(name, text.encode("utf-8", "backslashreplace"))
