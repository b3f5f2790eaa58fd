"""A `Place` in a bucket: objects below a prefix of an S3 service, read and written over HTTP by obstore.

An object appears whole or not at all, so nothing is renamed. Endpoint, region and credentials are what the environment says
(AWS_ENDPOINT_URL, AWS_REGION, AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, …); nothing of them is kept or printed.
"""

import contextlib
import os
import re
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from typing import Any, TypeVar

from kinetree.errors import ReadOnlyStoreError, ServiceError, StoreError
from kinetree.pipeline.storage.place import Listed

T = TypeVar("T")
_NAME = re.compile("[A-Za-z0-9][A-Za-z0-9._-]*")
LISTED_AT_ONCE = 1000
"""Objects in one answer of a service that lists."""
ASKED_AT_ONCE = 16
"""Requests under way where many objects are wanted: a service answers each after tens of milliseconds."""
RETRIES: Any = {"max_retries": 8, "retry_timeout": timedelta(minutes=3)}
"""A service that answers 503 is asked again, after pauses that grow."""
_STATUS = re.compile(r"non-2xx status code: (\d{3})")
_CERTIFICATE = re.compile(r"^\s*error: InvalidCertificate\(", re.MULTILINE)
"""In the causes of an error: to ask again is of no use."""
_UNKNOWN_NAME = re.compile(r"^\s*\"dns error\",$", re.MULTILINE)
_OVERLOADED = ("408", "429")
"""Statuses below 500 that say nothing of the request: too slow, too many."""


class Bucket:
    """A place at s3://bucket/prefix."""

    is_remote = True

    def __init__(self, url: str, name: str = "store") -> None:
        """Opens nothing; raises StoreError where the extra is not installed or the address is none.

        name : what messages call the place
        """
        self._name = name
        bucket, _, prefix = url.partition("://")[2].strip("/").partition("/")
        if not _NAME.fullmatch(bucket):  # it may be a password: it is not quoted
            raise StoreError(
                f"{name}: this is not the address of a bucket; expected s3://bucket/folder, and credentials in the environment"
                " (AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY) and not in the address"
            )
        self.url, self.prefix = url.rstrip("/"), prefix
        try:
            from obstore.store import S3Store
        except ImportError:
            raise StoreError(f"{name} {url}: s3:// needs a package that is not installed: pip install 'kinetree[s3]'") from None
        try:
            self._store: Any = S3Store(bucket, client_options=_client_options(), retry_config=RETRIES)
        except Exception as error:  # obstore raises many kinds for a wrong address
            raise StoreError(f"{name} {self.url}: {_short(error)}; expected s3://bucket/folder") from None

    def get(self, path: str) -> bytes | None:
        """The bytes at `path`; None where nothing is."""
        return self._asked(path, lambda store, key: bytes(store.get(key).bytes()))

    def get_all(self, paths: Iterable[str]) -> dict[str, bytes | None]:
        """The bytes at every path, several asked for at a time; None where nothing is."""
        wanted = list(paths)
        with ThreadPoolExecutor(ASKED_AT_ONCE) as pool:
            return dict(zip(wanted, pool.map(self.get, wanted), strict=True))

    def tail(self, path: str, count: int) -> tuple[bytes, int] | None:
        """The last bytes of an object, and how many it has in all; None where nothing is."""

        def last(store: Any, key: str) -> tuple[bytes, int]:
            try:
                answer = store.get(key, options={"range": {"suffix": count}})
            except FileNotFoundError:
                raise
            except Exception:  # an empty object has no last bytes: the service refuses the range
                if store.head(key)["size"]:
                    raise
                return b"", 0
            return bytes(answer.bytes()), int(answer.meta["size"])

        return self._asked(path, last)

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""
        return b"" if stop <= start else self._asked(path, lambda s, key: bytes(s.get_range(key, start=start, end=stop)))

    def put(self, path: str, data: bytes) -> None:
        """Writes one object."""
        with self._refusals("write", path):
            self._store.put(self._key(path), data)

    def look(self, path: str) -> Listed | None:
        """Size, time and tag of one object; None where nothing is."""
        return self._asked(path, lambda store, key: _listed(store.head(key)))

    def size(self, path: str) -> int | None:
        """Bytes of one object; None where nothing is."""
        listed = self.look(path)
        return None if listed is None else listed.size

    def names(self, path: str) -> list[str]:
        """Names directly below `path`, sorted; empty where nothing is."""
        with self._refusals("list", path):
            answer = self._store.list_with_delimiter(self._key(path) or None)
        below = [*(o["path"] for o in answer["objects"]), *answer["common_prefixes"]]
        return sorted({key.rstrip("/").rpartition("/")[2] for key in below})

    def listed(self, path: str) -> dict[str, Listed]:
        """Every object below `path`, by path relative to it, sorted; one request for a thousand of them."""
        key = self._key(path)
        top = f"{key}/" if key else ""
        with self._refusals("list", path):
            objects = [o for chunk in self._store.list(top or None, chunk_size=LISTED_AT_ONCE) for o in chunk]
        return dict(sorted((o["path"].removeprefix(top), _listed(o)) for o in objects))

    def children(self, path: str) -> dict[str, Listed]:
        """The objects directly below `path`, by name, sorted; empty where nothing is."""
        with self._refusals("list", path):
            objects = self._store.list_with_delimiter(self._key(path) or None)["objects"]
        return dict(sorted((o["path"].rpartition("/")[2], _listed(o)) for o in objects))

    def modified(self, path: str) -> float:
        """Seconds since the epoch of the last change of an object; 0 where nothing is."""
        listed = self.look(path)
        return 0.0 if listed is None else listed.modified

    def remove(self, path: str) -> None:
        """Removes an object, or all below a prefix; nothing happens where nothing is."""
        with self._refusals("remove", path):
            key = self._key(path)
            inside = [o["path"] for chunk in self._store.list(f"{key}/") for o in chunk]
            self._store.delete(inside or key)

    def remove_all(self, paths: Iterable[str]) -> None:
        """Removes objects; one request for a thousand of them."""
        keys = [self._key(path) for path in paths]
        with self._refusals("remove", "objects"):
            if keys:
                self._store.delete(keys)

    def _key(self, path: str) -> str:
        return "/".join(part for part in (self.prefix, path) if part)

    def _asked(self, path: str, ask: Callable[[Any, str], T]) -> T | None:
        with self._refusals("read", path):
            try:
                return ask(self._store, self._key(path))
            except FileNotFoundError:
                return None

    @contextlib.contextmanager
    def _refusals(self, verb: str, path: str) -> Iterator[None]:
        """Turns what the service refuses into an error that a user can act on, without what was sent to it."""
        try:
            yield
        except StoreError:
            raise
        except Exception as error:  # obstore raises one kind per service and cause
            failure = _failure_of_service(error)
            if failure:
                raise ServiceError(
                    f"{self._name} {self.url}: cannot {verb} {path or 'it'}: {failure}, also when asked again; check"
                    " AWS_ENDPOINT_URL, then run again to go on"
                ) from None
            if _CERTIFICATE.search(str(error)):
                raise StoreError(
                    f"{self._name} {self.url}: cannot {verb} {path or 'it'}: its certificate is not trusted on this machine;"
                    " check AWS_ENDPOINT_URL, or trust who signed it"
                ) from None
            is_read_only = verb == "write" and _short(error) == "PermissionDeniedError"
            raise (ReadOnlyStoreError if is_read_only else StoreError)(
                f"{self._name} {self.url}: cannot {verb} {path or 'it'}: {_short(error)}; check the address, and"
                " AWS_ENDPOINT_URL, AWS_REGION and the credentials in the environment"
            ) from None


def _listed(entry: Any) -> Listed:
    return Listed(int(entry["size"]), float(entry["last_modified"].timestamp()), str(entry["e_tag"] or ""))


def _client_options() -> Any:
    """Plain HTTP is spoken where the environment names such an endpoint, as on a network of one's own."""
    names = ("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL", "AWS_ENDPOINT")
    endpoint = next((os.environ[name] for name in names if os.environ.get(name)), "")
    return {"allow_http": endpoint.startswith("http://")}


def _failure_of_service(error: Exception) -> str:
    """What a service said that is no refusal of what was asked, in words; empty where it refused.

    obstore has one kind of error for all of it; the first line of its text is the request and what came of it, the others
    are its causes, a line each.
    """
    message = str(error).partition("\n")[0]
    status = _STATUS.search(message)
    if status is None:
        is_silent = "HTTP error: " in message and not _CERTIFICATE.search(str(error))
        what = (
            "no machine of the service's name is found" if _UNKNOWN_NAME.search(str(error)) else "the service does not answer"
        )
        return what if is_silent else ""
    is_failure = status[1].startswith("5") or status[1] in _OVERLOADED
    return f"the service answers {status[1]}" if is_failure else ""


def _short(error: Exception) -> str:
    """The kind of an error: its text may quote a request with what was signed into it."""
    return type(error).__name__
