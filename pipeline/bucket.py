"""A `Place` in a bucket: objects below a prefix of an S3 service, read and written over HTTP by obstore.

An object appears whole or not at all, so nothing is renamed. Endpoint, region and credentials are what the environment says
(AWS_ENDPOINT_URL, AWS_REGION, AWS_ACCESS_KEY_ID, AWS_SECRET_ACCESS_KEY, …); nothing of them is kept or printed.
"""

import contextlib
import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from datetime import timedelta
from typing import Any, TypeVar

from kinetree.errors import StoreError
from kinetree.pipeline.place import Listed

T = TypeVar("T")
LISTED_AT_ONCE = 1000
"""Objects in one answer of a service that lists."""
ASKED_AT_ONCE = 16
"""Requests under way where many objects are wanted: a service answers each after tens of milliseconds."""
RETRIES: Any = {"max_retries": 8, "retry_timeout": timedelta(minutes=3)}
"""A service that answers 503 is asked again, after pauses that grow."""


class Bucket:
    """A place at s3://bucket/prefix."""

    is_remote = True

    def __init__(self, url: str) -> None:
        """Opens nothing; raises StoreError where the extra is not installed or the address is none."""
        try:
            from obstore.store import S3Store
        except ImportError:
            raise StoreError(f"store {url}: s3:// needs a package that is not installed: pip install 'kinetree[s3]'") from None
        self.url = url.rstrip("/")
        self.prefix = self.url.partition("://")[2].partition("/")[2]
        try:
            bucket = self.url.partition("://")[2].partition("/")[0]
            self._store: Any = S3Store(bucket, client_options=_client_options(), retry_config=RETRIES)
        except Exception as error:  # obstore raises many kinds for a wrong address
            raise StoreError(f"store {self.url}: {_short(error)}; expected s3://bucket/folder") from None

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
                found = store.get(key, options={"range": {"suffix": count}})
            except FileNotFoundError:
                raise
            except Exception:  # an empty object has no last bytes: the service refuses the range
                if store.head(key)["size"]:
                    raise
                return b"", 0
            return bytes(found.bytes()), int(found.meta["size"])

        return self._asked(path, last)

    def part(self, path: str, start: int, stop: int) -> bytes | None:
        """The bytes from start to stop; None where nothing is."""
        return b"" if stop <= start else self._asked(path, lambda s, key: bytes(s.get_range(key, start=start, end=stop)))

    def put(self, path: str, data: bytes) -> None:
        """Writes one object."""
        with self._refusals("write", path):
            self._store.put(self._key(path), data)

    def size(self, path: str) -> int | None:
        """Bytes of one object; None where nothing is."""
        return self._asked(path, lambda store, key: int(store.head(key)["size"]))

    def names(self, path: str) -> list[str]:
        """Names directly below `path`, sorted; empty where nothing is."""
        with self._refusals("list", path):
            found = self._store.list_with_delimiter(self._key(path) or None)
        below = [*(o["path"] for o in found["objects"]), *found["common_prefixes"]]
        return sorted({key.rstrip("/").rpartition("/")[2] for key in below})

    def listed(self, path: str) -> dict[str, Listed]:
        """Every object below `path`, by path relative to it, sorted; one request for a thousand of them."""
        key = self._key(path)
        top = f"{key}/" if key else ""
        with self._refusals("list", path):
            found = [o for chunk in self._store.list(top or None, chunk_size=LISTED_AT_ONCE) for o in chunk]
        told = {o["path"].removeprefix(top): Listed(int(o["size"]), float(o["last_modified"].timestamp())) for o in found}
        return dict(sorted(told.items()))

    def modified(self, path: str) -> float:
        """Seconds since the epoch of the last change of an object; 0 where nothing is."""
        return self._asked(path, lambda store, key: float(store.head(key)["last_modified"].timestamp())) or 0.0

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
            raise StoreError(
                f"store {self.url}: cannot {verb} {path or 'it'}: {_short(error)}; check the address, and AWS_ENDPOINT_URL,"
                " AWS_REGION and the credentials in the environment"
            ) from None


def _client_options() -> Any:
    """Plain HTTP is spoken where the environment names such an endpoint, as on a network of one's own."""
    names = ("AWS_ENDPOINT_URL_S3", "AWS_ENDPOINT_URL", "AWS_ENDPOINT")
    endpoint = next((os.environ[name] for name in names if os.environ.get(name)), "")
    return {"allow_http": endpoint.startswith("http://")}


def _short(error: Exception) -> str:
    """The kind of an error: its text may quote a request with what was signed into it."""
    return type(error).__name__
