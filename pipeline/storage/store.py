"""The artifact store: what was computed, under the digest of what it is, and how it was computed, under the node's key.

    kinetree-store.json       says that this is a store, and of which format
    artifacts/ab/abcd….zip    one immutable zarr v3 group, zipped: arrays with dimension names and units, the rest as attributes
    records/, packs/          what a key made, and how: see records.py
    runs/, nodes/             what each run did and used: see run_records.py
    files.json                digests of the user's files
    tmp/                      half-written things; nobody reads them

An artifact is complete before a record names it. Any number of runs may share a store. Every array is checked against its
digest and its schema when it is read, everything in JSON against a checksum. Only arrays and JSON are stored: nothing is ever
unpickled.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from numpy.typing import NDArray
from pydantic import ValidationError

from kinetree.errors import ArtifactError, DamagedArtifactError, StoreError, UnknownNodeError
from kinetree.pipeline.identity.key import array_digest, combined_digest
from kinetree.pipeline.storage.groups import ForeignArrayError, decoded, group_files
from kinetree.pipeline.storage.overlay import Overlay, opened
from kinetree.pipeline.storage.packed import DamagedZipError, Packed, packed
from kinetree.pipeline.storage.place import Folder, Listed, Place
from kinetree.pipeline.storage.records import Record, Records
from kinetree.pipeline.storage.run_records import RunRecords, run_path
from kinetree.schemas.array import Array, Artifact, Loader

__all__ = ["Record", "Store", "artifact_path"]
A = TypeVar("A", bound=Artifact)
FORMAT = "kinetree.store/2"
MARKER = "kinetree-store.json"
ARTIFACTS = "artifacts"
PARTS = frozenset([MARKER, ARTIFACTS, "records", "packs", "runs", "nodes", "files.json", "tmp"])


@dataclass(frozen=True)
class Store:
    """A store in a place; making one reads and writes nothing."""

    place: Place
    records: Records = field(repr=False, compare=False)
    run_records: RunRecords = field(repr=False, compare=False)

    @staticmethod
    def at(url: str | Path) -> "Store":
        """The store at a folder's path or at s3://bucket/prefix; raises StoreError where something else lies there."""
        place = _place(str(url))
        store = Store._of(place)
        store._refuse_strangers()
        return store

    @staticmethod
    def _of(place: Place) -> "Store":
        return Store(place, Records(place), RunRecords(place))

    def unwritten(self) -> "Store":
        """The same store with an `Overlay`: what is written stays in the memory of this process, nothing reaches the place."""
        return Store._of(Overlay(self.place))

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

    def record(self, key: str, *, as_listed: bool = False) -> Record | None:
        """What `key` made; None where it made nothing yet or the record cannot be read; `as_listed` as in `Records.get`."""
        return self.records.get(key, as_listed=as_listed)

    def holds(self, record: Record) -> bool:
        """Whether the record's artifact lies there in its size (bytes are checked on reading)."""
        return self.place.size(artifact_path(record.artifact)) == record.bytes

    def publish(self, artifact: Artifact) -> tuple[str, int]:
        """Stores an artifact and returns its digest and its size in the store.

        One that is there with the same bytes stays; one with others is replaced, since it is damaged.
        """
        arrays, plain = artifact.arrays(), artifact.plain()
        digests = {name: array_digest(array) for name, array in arrays.items()}
        digest = combined_digest(type(artifact), plain, digests)
        head = {
            "schema": type(artifact).__name__,
            "version": type(artifact).version,
            "values": plain,
            "digests": digests,
        }
        data = packed(group_files({"kinetree": head}, arrays, type(artifact).array_fields()))
        path = artifact_path(digest)
        if self.place.size(path) != len(data) or self.place.get(path) != data:
            self.place.put(path, data)
        return digest, len(data)

    def write(self, record: Record) -> None:
        """Makes a published artifact known as what its key made."""
        self.records.put(record)

    def read(self, cls: type[A], digest: str) -> A:
        """The artifact of that digest; its arrays are read and checked when first asked for.

        raises : DamagedArtifactError, now or when an array is read, where bytes are missing or altered
        """
        group = self._group(digest)
        head = _head(group, digest)
        _refuse_altered(cls, head, digest)
        specs = cls.array_fields()
        loaders = {n: _loader(group, digest, n, specs[n], expected) for n, expected in head["digests"].items()}
        try:
            return cls.lazily(head["values"], loaders)
        except (ArtifactError, ValidationError) as error:
            raise DamagedArtifactError(digest, "its values are not those of its schema") from error

    def head(self, digest: str) -> dict[str, Any]:
        """Schema, version, JSON values and array digests of an artifact, as stored; raises DamagedArtifactError."""
        return _head(self._group(digest), digest)

    def group(self, cls: type[Artifact], digest: str) -> dict[str, bytes]:
        """The files of an artifact's zarr group, by path within it, every one checked; raises DamagedArtifactError."""
        self.read(cls, digest).arrays()
        group = self._group(digest)
        return _files(group, digest, group.spans)

    def check(self, digest: str, classes: Mapping[str, type[Artifact]]) -> None:
        """Reads all of an artifact; raises DamagedArtifactError. One of a class that is not known is checked by its digests."""
        group = self._group(digest)
        head = _head(group, digest)
        cls = classes.get(str(head["schema"]))
        if cls is not None and cls.version == head["version"]:
            self.read(cls, digest).arrays()
            return
        for name, expected in head["digests"].items():
            _loader(group, digest, name, None, expected)()

    def discard(self, digest: str) -> None:
        """Removes an artifact; records that name it then make nothing fresh."""
        self.place.remove(artifact_path(digest))

    def artifacts(self) -> dict[str, Listed]:
        """Size and time of every artifact there is, by digest."""
        return {path.rpartition("/")[2].removesuffix(".zip"): listed for path, listed in self.place.listed(ARTIFACTS).items()}

    def run_names(self) -> list[str]:
        """Identifiers of the runs on record, oldest first."""
        return self.run_records.names()

    def runs(self) -> list[dict[str, Any]]:
        """The runs on record with their nodes, oldest first, without those that cannot be read."""
        pairs = ((head, self.run_records.nodes(head)) for head in self.run_records.heads())
        return [{**head, "nodes": nodes} for head, nodes in pairs if nodes is not None]

    def run(self, name: str) -> dict[str, Any]:
        """The record of one run with its nodes; raises UnknownNodeError where there is none."""
        if Path(name).name != name or self.place.size(run_path(name)) is None:
            raise UnknownNodeError(f"no run {name!r} in {self.url}; kinetree runs lists them")
        head = self.run_records.head(name)
        nodes = self.run_records.nodes(head) if head is not None else None
        if head is None or nodes is None:
            raise StoreError(f"store {self.url}: {run_path(name)} is damaged; kinetree verify --repair removes it")
        return {**head, "nodes": nodes}

    def write_run(self, name: str, run: Mapping[str, Any]) -> None:
        """Writes or replaces the record of one run; its nodes lie apart, once for all runs that have the same."""
        self.run_records.write(name, run)

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
                    " --store, remove this one, or use the kinetree that wrote it"
                )
        elif isinstance(self.place, Folder) and self.place.root.is_file():
            raise StoreError(f"store {self.url}: this is a file; a store is a folder, name one with --store")
        elif set(self.place.names("")) - PARTS:
            raise StoreError(
                f"store {self.url}: this folder holds other things and is no kinetree store; name an empty or a new one"
            )

    def _group(self, digest: str) -> Packed:
        try:
            group = Packed.at(self.place, artifact_path(digest))
        except DamagedZipError as error:
            raise DamagedArtifactError(digest, str(error)) from error
        if group is None:
            raise DamagedArtifactError(digest, "it is missing")
        return group


def _place(url: str) -> Place:
    overlay = opened(url)
    if overlay is not None:
        return overlay
    scheme, separator, _ = url.partition("://")
    if not separator:
        return Folder(Path(url).expanduser())
    if scheme != "s3":
        raise StoreError(f"store {url}: {scheme}:// is not supported; give a folder or s3://bucket/folder")
    from kinetree.pipeline.storage.bucket import Bucket

    return Bucket(url)


def artifact_path(digest: str) -> str:
    """Where in a store the artifact of that digest lies."""
    return f"{ARTIFACTS}/{digest[:2]}/{digest}.zip"


def _head(group: Packed, digest: str) -> dict[str, Any]:
    data = _files(group, digest, ["zarr.json"])["zarr.json"]
    try:
        head = json.loads(data)["attributes"]["kinetree"]
        return {name: head[name] for name in ("schema", "version", "values", "digests")}
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise DamagedArtifactError(digest, "its metadata cannot be read") from error


def _refuse_altered(cls: type[Artifact], head: Mapping[str, Any], digest: str) -> None:
    """What a group says of itself must be what its digest was made of, and what its schema says."""
    if (head["schema"], head["version"]) != (cls.__name__, cls.version):
        raise DamagedArtifactError(digest, f"holds {head['schema']}/{head['version']}, not {cls.__name__}")
    try:
        actual = combined_digest(cls, head["values"], head["digests"])
    except (TypeError, AttributeError):
        actual = ""
    if actual != digest or set(head["digests"]) != set(cls.array_fields()):
        raise DamagedArtifactError(digest, "its attributes were altered")


def _loader(group: Packed, digest: str, name: str, spec: Array | None, expected: str) -> Loader:
    def load() -> NDArray[Any]:
        try:
            files = group.read([path for path in group.spans if path.startswith(f"{name}/")])
            array = decoded({path.removeprefix(f"{name}/"): data for path, data in files.items()}, spec)
        except StoreError:  # what cannot be reached is not damaged
            raise
        except (ForeignArrayError, DamagedZipError) as error:
            raise DamagedArtifactError(digest, f"array {name}: {error}") from error
        except Exception as error:  # whatever a codec says of altered bytes
            raise DamagedArtifactError(digest, f"array {name} cannot be read ({type(error).__name__})") from error
        if array_digest(array) != expected:
            raise DamagedArtifactError(digest, f"array {name} was altered")
        return array

    return load


def _files(group: Packed, digest: str, names: Any) -> dict[str, bytes]:
    try:
        return group.read(names)
    except DamagedZipError as error:
        raise DamagedArtifactError(digest, str(error)) from error
    except KeyError as error:
        raise DamagedArtifactError(digest, "a file is missing") from error
