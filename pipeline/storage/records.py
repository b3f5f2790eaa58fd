"""Records: what a key made and how. Each is written alone, when its artifact is there; a run that is over packs its own.

    records/<key>.json       one record, sealed
    packs/<run>.zip          the records of a run, each as <key>.json

A reader sees a record in either place: the pack is complete before the single ones go.
"""

import io
import math
import re
import threading
import time
import zipfile
from collections.abc import Collection, Iterable, Iterator
from dataclasses import asdict, dataclass, field
from typing import Any

from kinetree.pipeline.storage.groups import UNPACKED_BYTES, UNPACKED_RATIO
from kinetree.pipeline.storage.packed import packed
from kinetree.pipeline.storage.place import Place
from kinetree.pipeline.storage.sealed import sealed, unsealed

PACKED_FROM = 16
"""Fewer records than this are left single."""
RECORD_BYTES = 64 * 2**20
"""More bytes than any record has: one that names a million inputs. A larger one in a pack is damaged and never unpacked."""
LISTED_SECONDS = 5.0
"""How long a listing of packs is good for."""
_COMPRESSED = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED)
"""How `packed` writes; others unpack a piece of any size at once."""
_KEY = re.compile("[0-9a-f]{40}")
Packs = dict[str, zipfile.ZipFile | None]
"""By name; None where it cannot be read."""


@dataclass(frozen=True)
class Record:
    """What one key made, and how."""

    key: str
    task: str
    index: dict[str, int]
    artifact: str
    bytes: int
    """Bytes the artifact takes in the store."""
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
    own_bytes: int = 0
    """Bytes by which the process grew at most while it computed the node; 0 where it computed others beside it."""


@dataclass
class Records:
    """The records in one place; what was listed is remembered for a moment."""

    place: Place
    _single: set[str] = field(default_factory=set)
    _packs: Packs = field(default_factory=dict)
    _where: dict[str, str] = field(default_factory=dict)
    _listed: float = float("-inf")
    _lock: threading.Lock = field(default_factory=threading.Lock)

    def get(self, key: str, *, as_listed: bool = False) -> Record | None:
        """What `key` made; None where it made nothing yet or the record cannot be read.

        as_listed : a key that was not there when the records were listed, which is moments ago, is not asked for again
        """
        if time.monotonic() - self._listed > LISTED_SECONDS:
            self._list()
        packed = self._packed(key) if key not in self._single else None
        if packed is not None or (as_listed and key not in self._single):
            return packed
        data = self.place.get(_single(key))
        if data is None and key in self._single:
            self._list()  # it was packed or freed meanwhile
            return self._packed(key)
        return _checked(data, key)

    def singles(self) -> dict[str, Record]:
        """By key, the readable records that lie alone."""
        self._list()
        files = self._read_singles(self._single)
        records = {key: _checked(data, key) for key, data in files.items()}
        return {key: record for key, record in records.items() if record is not None}

    def look_again(self) -> None:
        """What other processes wrote or packed meanwhile is seen from now on."""
        self._listed = float("-inf")

    def put(self, record: Record) -> None:
        """Writes or replaces one record."""
        self.place.put(_single(record.key), sealed(asdict(record)))
        self._single.add(record.key)

    def all(self) -> Iterator[Record]:
        """Every readable record."""
        for key in self.listed():
            record = self.get(key)
            if record is not None:
                yield record

    def listed(self) -> list[str]:
        """The keys of all records there are now, readable or not."""
        self._list()
        return sorted({*self._single, *self._where})

    def since(self, epoch: float) -> set[str]:
        """The keys of the records that were written, or lie in a pack that was written, at a time or after it.

        epoch : seconds since the epoch; no place is asked where it is infinite, since all or none are after it
        """
        if math.isinf(epoch):
            return {*self._single, *self._where} if epoch < 0 else set()
        packs = {name for name in self._packs if self.place.modified(_pack(name)) >= epoch}
        packed = {key for key, name in self._where.items() if name in packs and key not in self._single}
        return packed | {key for key in self._single if self.place.modified(_single(key)) >= epoch}

    def pack(self, name: str, keys: Collection[str]) -> None:
        """Puts the single records of these keys into one pack of that name, if they are many."""
        self._list()
        by_key = self._read_singles(self._single & set(keys))
        files = {f"{key}.json": data for key, data in by_key.items() if data is not None and _checked(data, key) is not None}
        if len(files) >= PACKED_FROM:
            self.place.put(_pack(name), packed(files, is_deflated=True))
            self.place.remove_all(f"records/{file}" for file in files)
            self._list()

    def remove(self, keys: Collection[str]) -> None:
        """Removes records; packs that held some are written again without them."""
        gone = set(keys)
        self.place.remove_all(_single(key) for key in sorted(gone & self._single))
        for name in sorted({self._where[key] for key in gone if key in self._where}):
            archive = self._packs[name]
            files = {f: self._bytes(name, f) for f in (archive.namelist() if archive else ()) if f[:-5] not in gone}
            whole = {file: data for file, data in files.items() if data is not None}
            if whole:
                self.place.put(_pack(name), packed(whole, is_deflated=True))
            else:
                self.place.remove(_pack(name))
            self._packs = {other: pack for other, pack in self._packs.items() if other != name}  # it is read again
            self._where = {key: pack for key, pack in self._where.items() if pack != name}
        self._list()

    def damaged(self) -> list[str]:
        """The paths of records and packs that cannot be read."""
        self._list()
        packs = [_pack(name) for name, archive in self._packs.items() if archive is None]
        inside = [f"{_pack(name)}: {key}.json" for key, name in self._where.items() if self._packed(key) is None]
        return [*packs, *inside, *map(_single, self._damaged_singles())]

    def discard_damaged(self) -> None:
        """Removes what `damaged` names."""
        self._list()
        for name in [name for name, archive in self._packs.items() if archive is None]:
            self.place.remove(_pack(name))
        packs = {key for key in self._where if self._packed(key) is None}
        self.remove(packs | set(self._damaged_singles()))

    def _damaged_singles(self) -> list[str]:
        return [key for key, data in self._read_singles(self._single).items() if _checked(data, key) is None]

    def _read_singles(self, keys: Iterable[str]) -> dict[str, bytes | None]:
        by_path = self.place.get_all(map(_single, wanted := sorted(keys)))
        return {key: by_path[_single(key)] for key in wanted}

    def _list(self) -> None:
        with self._lock:
            single = {name.removesuffix(".json") for name in self.place.names("records")}
            there = [name.removesuffix(".zip") for name in self.place.names("packs") if name.endswith(".zip")]
            known = self._packs
            new = self.place.get_all(_pack(name) for name in there if not known.get(name))
            self._packs = {name: known.get(name) or _opened(new[_pack(name)]) for name in there}
            self._where = _placed(self._where, known, self._packs)
            self._single = {key for key in single if _KEY.fullmatch(key)}
            self._listed = time.monotonic()

    def _packed(self, key: str) -> Record | None:
        name = self._where.get(key)
        return _checked(self._bytes(name, f"{key}.json"), key) if name is not None else None

    def _bytes(self, name: str, file: str) -> bytes | None:
        archive = self._packs.get(name)
        try:
            if archive is None or archive.getinfo(file).file_size > RECORD_BYTES:
                return None
            return archive.read(file)
        except Exception:  # zipfile and zlib raise many kinds for altered bytes
            return None


def _placed(before: dict[str, str], known: Packs, packs: Packs) -> dict[str, str]:
    """The pack of every key; only those that were not known are looked through, since a store may have thousands of others."""
    if packs == known:
        return before
    same = {name for name, archive in known.items() if packs.get(name) is archive}
    where = dict(before) if len(same) == len(known) else {key: name for key, name in before.items() if name in same}
    for name, archive in packs.items():
        if archive is not None and name not in same:
            where.update((file[:-5], name) for file in archive.namelist() if _KEY.fullmatch(file[:-5]))
    return where


def _single(key: str) -> str:
    return f"records/{key}.json"


def _pack(name: str) -> str:
    return f"packs/{name}.zip"


def _opened(data: bytes | None) -> zipfile.ZipFile | None:
    """A pack in memory; None where its bytes are none, or would unpack to far more than they are."""
    try:
        archive = zipfile.ZipFile(io.BytesIO(data or b""))
    except Exception:  # zipfile raises many kinds for altered bytes
        return None
    infos = archive.infolist()
    is_bounded = sum(info.file_size for info in infos) <= max(UNPACKED_BYTES, UNPACKED_RATIO * len(data or b""))
    return archive if is_bounded and all(info.compress_type in _COMPRESSED for info in infos) else None


def _checked(data: bytes | None, key: str) -> Record | None:
    try:
        record = Record(**unsealed(data))
    except TypeError:
        return None
    is_sound = record.key == key and _KEY.fullmatch(str(record.artifact)) and type(record.bytes) is int
    return record if is_sound else None
