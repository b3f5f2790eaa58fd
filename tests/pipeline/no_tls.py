"""Connects with certificates, given as JSON, to those who speak no TLS; prints by what they say the error and what stays."""

import contextlib
import json
import socket
import sys
import threading
from collections.abc import Iterator

from kinetree.errors import KinetreeError
from kinetree.pipeline.running import clusters
from kinetree.pipeline.settings.config import Compute

SPOKEN = {
    "hangs up": None,
    "hangs up when it is spoken to": b"",
    "text": b"no TLS\r\n" * 100,
    "dask without TLS": (2).to_bytes(8, "little") * 3,
    "a handshake of nonsense": b"\x16\x03\x03\x00\x40" + b"z" * 64,
    "a record of nonsense": b"\x16\x03\x01\xff\xff" + b"z" * 64,
}


@contextlib.contextmanager
def listener(spoken: bytes | None) -> Iterator[int]:
    """A port at which somebody hears what is said to him, unless `spoken` is None, says that much and hangs up."""

    def answer() -> None:
        with contextlib.suppress(OSError):
            while True:
                caller, _ = there.accept()
                with caller:
                    if spoken is not None:
                        caller.recv(2**16)
                        caller.sendall(spoken)

    with socket.create_server(("127.0.0.1", 0)) as there:
        threading.Thread(target=answer, daemon=True).start()
        yield there.getsockname()[1]


def refusal(spoken: bytes | None, certificates: dict[str, str]) -> tuple[str, str, list[str]]:
    """The error's class and words, and the event loops of clients that are still there."""
    with listener(spoken) as port:
        try:
            with clusters.at(Compute(scheduler=f"tls://127.0.0.1:{port}", security=certificates)):
                return "", "", []
        except KinetreeError as error:
            loops = [thread.name for thread in threading.enumerate() if thread.name == "IO loop"]
            return type(error).__name__, str(error), loops


if __name__ == "__main__":
    certificates = json.loads(sys.argv[1])
    print(json.dumps({who: refusal(spoken, certificates) for who, spoken in SPOKEN.items()}))
