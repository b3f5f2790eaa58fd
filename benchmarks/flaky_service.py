"""A service of S3 that answers some share of its requests with an error: what stands between a store and moto's server."""

import http.client
import random
import subprocess
import sys
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

SERVER = """
import sys
from moto.server import ThreadedMotoServer
server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
server.start()
print(server.get_host_and_port()[1], flush=True)
sys.stdin.read()
"""
DROPPED = ("transfer-encoding", "connection", "content-length")


class FlakyService(ThreadingHTTPServer):
    """Passes requests on to a server of its own; `share` of them is answered with `status` instead."""

    daemon_threads = True

    def __init__(self, seed: int) -> None:
        super().__init__(("127.0.0.1", 0), _Passing)
        command = [sys.executable, "-c", SERVER]
        self.behind = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True
        )
        assert self.behind.stdout is not None
        self.port = int(self.behind.stdout.readline())
        self.status, self.share = 503, 0.0
        self.rng = random.Random(seed)
        self.bucket = "bucket"
        connection = http.client.HTTPConnection("127.0.0.1", self.port)
        connection.request("PUT", f"/{self.bucket}")
        assert connection.getresponse().status == 200
        connection.close()
        threading.Thread(target=self.serve_forever, daemon=True).start()

    @property
    def environment(self) -> dict[str, str]:
        """What a store in it needs to be found."""
        endpoint = f"http://127.0.0.1:{self.server_address[1]}"
        keys = {"AWS_ACCESS_KEY_ID": "key", "AWS_SECRET_ACCESS_KEY": "secret", "AWS_REGION": "us-east-1"}
        return {"AWS_ENDPOINT_URL": endpoint, **keys}

    def end(self) -> None:
        """Ends it and the server behind it."""
        self.shutdown()
        self.server_close()
        self.behind.kill()
        self.behind.communicate()


class _Passing(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    server: FlakyService

    def _pass_on(self) -> None:
        body = self.rfile.read(int(self.headers.get("Content-Length", 0)))
        if self.server.rng.random() < self.server.share:
            self._answer(self.server.status, [("Content-Length", "0")], b"")
            return
        behind = http.client.HTTPConnection("127.0.0.1", self.server.port)
        behind.request(self.command, self.path, body, dict(self.headers))
        answer = behind.getresponse()
        data = answer.read()
        headers = [(name, value) for name, value in answer.getheaders() if name.lower() not in DROPPED]
        length = answer.getheader("Content-Length") if self.command == "HEAD" else str(len(data))
        self._answer(answer.status, [*headers, ("Content-Length", length or "0")], data)
        behind.close()

    def _answer(self, status: int, headers: list[tuple[str, str]], data: bytes) -> None:
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)

    do_GET = do_PUT = do_HEAD = do_POST = do_DELETE = _pass_on  # noqa: N815 - as the library calls them

    def log_message(self, *_: object) -> None:
        """Says nothing."""
