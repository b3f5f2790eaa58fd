"""JSON with its own checksum: an altered byte makes it nothing, never something else.

    {"blake2b": "40 hexadecimal digits", "content": …}

The checksum is that of the bytes after `"content": ` without the last brace. Any reader of JSON reads it.
"""

import hashlib
import json
from typing import Any

_HEAD = b'{"blake2b": "'
_MIDDLE = b'", "content": '
_DIGITS = 40


def sealed(content: Any) -> bytes:
    """A JSON value as bytes that tell whether they were altered."""
    body = json.dumps(content, separators=(",", ":")).encode()
    return b"".join((_HEAD, _checksum(body), _MIDDLE, body, b"}"))


def unsealed(data: bytes | None) -> Any:
    """The value; None where there is none or its bytes are not as they were written."""
    begin = len(_HEAD) + _DIGITS + len(_MIDDLE)
    if data is None or data[: len(_HEAD)] != _HEAD or data[begin - len(_MIDDLE) : begin] != _MIDDLE or data[-1:] != b"}":
        return None
    body = data[begin:-1]
    if data[len(_HEAD) : len(_HEAD) + _DIGITS] != _checksum(body):
        return None
    try:
        return json.loads(body)
    except (ValueError, RecursionError):
        return None


def _checksum(body: bytes) -> bytes:
    return hashlib.blake2b(body, digest_size=_DIGITS // 2).hexdigest().encode()
