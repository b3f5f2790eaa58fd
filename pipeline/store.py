"""The artifact store: what was computed, under the digest of what it is, and how it was computed, under the node's key.

    kinetree-store.json      says that this is a store, and of which format
    artifacts/ab/abcd…/      one immutable zarr v3 group: arrays with dimension_names and units, other fields as attributes
    records/ab/abcd….json    what a key made, and how
    runs/<id>.json           what each run used
    tmp/                     half-written things; nobody reads them

A group is complete before a record names it. Any number of runs may share a store. Every array is checked against its
digest when it is read. Only arrays and JSON are stored: nothing is ever unpickled.
"""

import json
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from numpy.typing import NDArray

from kinetree.errors import DamagedArtifactError, StoreError, UnknownNodeError
from kinetree.pipeline.key import array_digest, combined_digest
from kinetree.pipeline.place import Folder, Place
from kinetree.schemas.array import Array, Artifact, Loader

A = TypeVar("A", bound=Artifact)
FORMAT = "kinetree.store/1"
MARKER = "kinetree-store.json"
CHUNK_BYTES = 64 * 2**20


@dataclass(frozen=True)
class Record:
    """What one key made, and how."""

    key: str
    task: str
    index: dict[str, int]
    artifact: str
    files: dict[str, int]
    params: dict[str, Any]
    code: dict[str, str]
    """By module, the definitions of which its code digest was made, each with a short digest."""
    inputs: list[Any]
    seconds: float
    peak_bytes: int
    host: str
    created: str
    versions: dict[str, str] = field(default_factory=dict)
    asks_index: bool = False
    """Whether the index is part of the key."""

    @property
    def bytes(self) -> int:
        """Bytes the artifact takes on disk."""
        return sum(self.files.values())


@dataclass(frozen=True)
class Store:
    """A store in a place; making one reads and writes nothing."""

    place: Place

    @staticmethod
    def at(url: str | Path) -> "Store":
        """The store at a folder's path; raises StoreError where something else lies there."""
        text = str(url)
        if "://" in text:
            scheme = text.partition("://")[0]
            raise StoreError(f"store {text}: {scheme}:// is not supported yet; give a folder")
        store = Store(Folder(Path(text).expanduser()))
        store._refuse_strangers()
        return store

    @property
    def url(self) -> str:
        """Where the store is, as a worker is told."""
        return self.place.url

    @property
    def exists(self) -> bool:
        """Whether anything was ever stored here."""
        return self.place.size(MARKER) is not None

    def create(self) -> None:
        """Makes the place a store; nothing happens where it is one."""
        if not self.exists:
            self.place.put(MARKER, json.dumps({"format": FORMAT}).encode())

    def record(self, key: str) -> Record | None:
        """What `key` made; None where it made nothing yet or the record cannot be read."""
        data = self.place.get(_record_path(key))
        if data is None:
            return None
        try:
            record = Record(**json.loads(data))
        except (ValueError, TypeError):
            return None
        is_sound = record.key == key and re.fullmatch("[0-9a-f]{40}", str(record.artifact)) and isinstance(record.files, dict)
        return record if is_sound else None

    def records(self) -> Iterator[Record]:
        """Every readable record."""
        for shard in self.place.names("records"):
            for name in self.place.names(f"records/{shard}"):
                record = self.record(name.removesuffix(".json"))
                if record is not None:
                    yield record

    def holds(self, record: Record) -> bool:
        """Whether the record's artifact lies there with every file in its size (bytes are checked on reading)."""
        top = artifact_path(record.artifact)
        return all(self.place.size(f"{top}/{name}") == size for name, size in record.files.items())

    def publish(self, artifact: Artifact) -> tuple[str, dict[str, int]]:
        """Stores an artifact and returns its digest and the size of each of its files."""
        arrays, plain = artifact.arrays(), artifact.plain()
        digests = {name: array_digest(array) for name, array in arrays.items()}
        digest = combined_digest(type(artifact), plain, digests)
        head = {
            "schema": type(artifact).__name__,
            "version": type(artifact).version,
            "values": plain,
            "digests": digests,
        }
        files = _zarr_group(head, arrays, type(artifact).array_fields())
        self.place.put_all(artifact_path(digest), files)
        return digest, {name: len(data) for name, data in files.items()}

    def write(self, record: Record) -> None:
        """Makes a published artifact known as what its key made."""
        self.place.put(_record_path(record.key), json.dumps(asdict(record), separators=(",", ":")).encode())

    def read(self, cls: type[A], digest: str) -> A:
        """The artifact of that digest; its arrays are read and checked when first asked for.

        raises : DamagedArtifactError, now or when an array is read, where bytes are missing or altered
        """
        head = self.head(digest)
        if (head.get("schema"), head.get("version")) != (cls.__name__, cls.version):
            raise DamagedArtifactError(digest, f"holds {head.get('schema')}/{head.get('version')}, not {cls.__name__}")
        if combined_digest(cls, head["values"], head["digests"]) != digest:
            raise DamagedArtifactError(digest, "its attributes were altered")
        return cls.lazily(head["values"], {name: self._loader(digest, name, head["digests"][name]) for name in head["digests"]})

    def head(self, digest: str) -> dict[str, Any]:
        """Schema, version, JSON values and array digests of an artifact, as stored; raises DamagedArtifactError."""
        data = self.place.get(f"{artifact_path(digest)}/zarr.json")
        if data is None:
            raise DamagedArtifactError(digest, "it is missing")
        try:
            head = json.loads(data)["attributes"]["kinetree"]
            return {name: head[name] for name in ("schema", "version", "values", "digests")}
        except (ValueError, KeyError, TypeError) as error:
            raise DamagedArtifactError(digest, "its metadata cannot be read") from error

    def group(self, digest: str) -> dict[str, bytes]:
        """The files of an artifact's zarr group, by path within it; raises DamagedArtifactError where one is missing."""
        top = artifact_path(digest)
        files = {name: self.place.get(f"{top}/{name}") for name in self.place.tree(top)}
        if None in files.values() or "zarr.json" not in files:
            raise DamagedArtifactError(digest, "a file is missing")
        return {name: data for name, data in files.items() if data is not None}

    def sizes(self, digest: str) -> Mapping[str, int]:
        """Size of every file of an artifact's zarr group, by path within it."""
        return self.place.tree(artifact_path(digest))

    def discard(self, digest: str) -> None:
        """Removes an artifact; records that name it then make nothing fresh."""
        self.place.remove(artifact_path(digest))

    def run_names(self) -> list[str]:
        """Identifiers of the runs on record, oldest first."""
        return [n.removesuffix(".json") for n in self.place.names("runs") if n.endswith(".json")]

    def run(self, name: str) -> dict[str, Any]:
        """The record of one run; raises UnknownNodeError where there is none."""
        data = self.place.get(f"runs/{name}.json") if Path(name).name == name else None
        if data is None:
            raise UnknownNodeError(f"no run {name!r} in {self.url}; kinetree runs lists them")
        try:
            run = json.loads(data)
        except ValueError:
            run = None
        if not isinstance(run, dict) or not isinstance(run.get("nodes"), dict):
            raise StoreError(f"store {self.url}: runs/{name}.json is damaged; delete it")
        return run

    def write_run(self, name: str, run: Mapping[str, Any]) -> None:
        """Writes or replaces the record of one run."""
        self.place.put(f"runs/{name}.json", json.dumps(run, separators=(",", ":")).encode())

    def _refuse_strangers(self) -> None:
        data = self.place.get(MARKER)
        if data is not None:
            try:
                version = json.loads(data).get("format")
            except (ValueError, AttributeError):
                version = "unreadable"
            if version != FORMAT:
                raise StoreError(
                    f"store {self.url}: its format is {version!r}, this version reads {FORMAT!r}; name another folder with"
                    " --store, or use the kinetree that wrote it"
                )
        elif Path(self.place.url).is_file():
            raise StoreError(f"store {self.url}: this is a file; a store is a folder, name one with --store")
        elif set(self.place.names("")) - {"tmp"}:
            raise StoreError(
                f"store {self.url}: this folder holds other things and is no kinetree store; name an empty or a new one"
            )

    def _loader(self, digest: str, name: str, expected: str) -> Loader:
        def load() -> NDArray[Any]:
            array = self._array(digest, name)
            if array_digest(array) != expected:
                raise DamagedArtifactError(digest, f"array {name} was altered")
            return array

        return load

    def _array(self, digest: str, name: str) -> NDArray[Any]:
        import zarr
        from zarr.storage import MemoryStore

        top = f"{artifact_path(digest)}/{name}"
        objects = {path: self.place.get(f"{top}/{path}") for path in self.place.tree(top)}
        held = {path: _buffer(data) for path, data in objects.items() if data is not None}
        try:
            array = zarr.open_array(store=MemoryStore(held), mode="r")
            if len(held) <= array.nchunks and array.size:
                raise DamagedArtifactError(digest, f"a chunk of array {name} is missing")
            return np.asarray(array[...])
        except DamagedArtifactError:
            raise
        except Exception as error:  # whatever a codec says of altered bytes
            raise DamagedArtifactError(digest, f"array {name} cannot be read ({type(error).__name__})") from error


def artifact_path(digest: str) -> str:
    """Where in a store the artifact of that digest lies."""
    return f"artifacts/{digest[:2]}/{digest}"


def group_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Arrays and attributes of a zarr group lying anywhere, by name; attributes as 0-d arrays.

    raises : StoreError where there is no readable group
    """
    import zarr

    try:
        group = zarr.open_group(path, mode="r")
        held = {name: np.asarray(array[...]) for name, array in group.arrays()}
        held.update({name: np.asarray(value) for name, value in group.attrs.items() if name not in held})
    except Exception as error:  # zarr and its codecs raise many kinds for one fact
        raise StoreError(f"{path}: not a readable zarr group ({type(error).__name__}: {error})") from error
    return held


def is_array(path: Path) -> bool:
    """Whether one zarr array, not a group, lies at a path."""
    if (path / ".zarray").is_file():
        return True
    try:
        head = json.loads((path / "zarr.json").read_bytes())
    except (OSError, ValueError):
        return False
    return isinstance(head, dict) and head.get("node_type") == "array"


def opened_array(path: Path) -> tuple[Any, dict[str, Any]]:
    """A zarr array lying anywhere, to be sliced and not read yet, and its attributes; raises StoreError."""
    import zarr

    try:
        array = zarr.open_array(path, mode="r")
        return array, dict(array.attrs)
    except Exception as error:  # zarr and its codecs raise many kinds for one fact
        raise StoreError(f"{path}: not a readable zarr array ({type(error).__name__}: {error})") from error


def _record_path(key: str) -> str:
    return f"records/{key[:2]}/{key}.json"


def _zarr_group(
    head: Mapping[str, Any], arrays: Mapping[str, NDArray[Any]], specs: Mapping[str, Array]
) -> dict[str, bytes]:
    """The files of a zarr v3 group, made in memory: one write per file then, wherever the place is."""
    import zarr
    from zarr.codecs import ZstdCodec
    from zarr.storage import MemoryStore

    held: dict[str, Any] = {}
    group = zarr.create_group(store=MemoryStore(held), attributes={"kinetree": dict(head)})
    for name, array in arrays.items():
        group.create_array(
            name,
            data=array,
            chunks=_chunks(array.shape, array.dtype.itemsize),
            dimension_names=[dim.name for dim in specs[name].dims],
            attributes={"unit": specs[name].unit},
            compressors=ZstdCodec(level=1),
            config={"write_empty_chunks": True},
        )
    return {name: data.to_bytes() for name, data in held.items()}


def _chunks(shape: Sequence[int], itemsize: int) -> tuple[int, ...]:
    """The whole array up to 64 MiB, then slabs of the first dimension."""
    if not shape:
        return ()
    row = itemsize * int(np.prod(shape[1:], dtype=np.int64)) or itemsize
    return (max(1, min(shape[0], CHUNK_BYTES // row)), *(max(1, n) for n in shape[1:]))


def _buffer(data: bytes) -> Any:
    from zarr.core.buffer import default_buffer_prototype

    return default_buffer_prototype().buffer.from_bytes(data)
