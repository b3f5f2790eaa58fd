"""A server that speaks S3 over HTTP on this machine, and what stands between it and a test: pauses, refusals, counts."""

import http.client
import itertools
import subprocess
import sys
import threading
import time
from collections import Counter
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

SERVER = """
from moto.server import ThreadedMotoServer
import sys
server = ThreadedMotoServer(ip_address="127.0.0.1", port=0, verbose=False)
server.start()
print(server.get_host_and_port()[1], flush=True)
sys.stdin.read()
"""
SECRET = "the-secret-of-the-test"


class Between(ThreadingHTTPServer):
    """Passes requests on, each after a pause; every so many are answered `status` instead."""

    daemon_threads = True

    def __init__(self, port):
        super().__init__(("127.0.0.1", 0), Passing)
        self.behind, self.pause, self.refuse_every, self.status = port, 0.0, 0, 503
        self.refuse_from = None
        """The request from which on all are refused."""
        self.count = itertools.count(1)
        self.refused = self.requests = 0
        self.asked = Counter()
        """How often each kind of request came: GET, HEAD, …, and LIST."""


class Passing(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def pass_on(self):
        server, body = self.server, self.rfile.read(int(self.headers.get("Content-Length", 0)))
        server.requests += 1
        server.asked["LIST" if "list-type" in self.path else self.command] += 1
        time.sleep(server.pause)
        is_out = server.refuse_from is not None and server.requests >= server.refuse_from
        if is_out or (server.refuse_every and next(server.count) % server.refuse_every == 0):
            server.refused += 1
            self.answer(server.status, [("Content-Length", "0")], b"")
            return
        behind = http.client.HTTPConnection("127.0.0.1", server.behind)
        behind.request(self.command, self.path, body, dict(self.headers))
        answer = behind.getresponse()
        data = answer.read()
        dropped = ("transfer-encoding", "connection", "content-length")
        headers = [(name, value) for name, value in answer.getheaders() if name.lower() not in dropped]
        length = answer.getheader("Content-Length") if self.command == "HEAD" else str(len(data))
        self.answer(answer.status, [*headers, ("Content-Length", length or "0")], data)
        behind.close()

    def answer(self, status, headers, data):
        self.send_response(status)
        for name, value in headers:
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(data)

    do_GET = do_PUT = do_HEAD = do_POST = do_DELETE = pass_on  # noqa: N815 - as the library calls them

    def log_message(self, *_):
        pass


@pytest.fixture(scope="module")
def behind():
    """The port of a server of S3 in a process of its own."""
    pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([sys.executable, "-c", SERVER], text=True, **pipes) as process:
        yield int(process.stdout.readline())
        process.kill()


@pytest.fixture
def service(behind, monkeypatch, request):
    """What stands between the store and the server, and a bucket of the test's own."""
    between = Between(behind)
    threading.Thread(target=between.serve_forever, daemon=True).start()
    for name, value in {
        "AWS_ENDPOINT_URL": f"http://127.0.0.1:{between.server_address[1]}", "AWS_ACCESS_KEY_ID": "key",
        "AWS_SECRET_ACCESS_KEY": SECRET, "AWS_REGION": "us-east-1",
    }.items():  # fmt: skip
        monkeypatch.setenv(name, value)
    between.bucket = f"b{abs(hash(request.node.name)):x}"
    connection = http.client.HTTPConnection("127.0.0.1", behind)
    connection.request("PUT", f"/{between.bucket}")
    assert connection.getresponse().status == 200
    connection.close()
    yield between
    between.shutdown()
    between.server_close()
