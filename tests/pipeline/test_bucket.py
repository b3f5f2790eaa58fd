"""A store in a bucket of a server that speaks S3 over HTTP: laws of a place, slow answers, refusals, two runs at once."""

import http.client
import itertools
import subprocess
import sys
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import pytest

from kinetree.errors import StoreError
from kinetree.pipeline.gc import collect
from kinetree.pipeline.store import Store
from kinetree.pipeline.verify import verify

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
    """Passes requests on, each after a pause; every so many are answered 503 instead."""

    daemon_threads = True

    def __init__(self, port):
        super().__init__(("127.0.0.1", 0), Passing)
        self.behind, self.pause, self.refuse_every = port, 0.0, 0
        self.count = itertools.count(1)
        self.refused = self.requests = 0


class Passing(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def pass_on(self):
        server, body = self.server, self.rfile.read(int(self.headers.get("Content-Length", 0)))
        server.requests += 1
        time.sleep(server.pause)
        if server.refuse_every and next(server.count) % server.refuse_every == 0:
            server.refused += 1
            self.answer(503, [("Content-Length", "0")], b"")
            return
        behind = http.client.HTTPConnection("127.0.0.1", server.behind)
        behind.request(self.command, self.path, body, dict(self.headers))
        answer = behind.getresponse()
        data = answer.read()
        dropped = ("transfer-encoding", "connection", "content-length")
        kept = [(name, value) for name, value in answer.getheaders() if name.lower() not in dropped]
        length = answer.getheader("Content-Length") if self.command == "HEAD" else str(len(data))
        self.answer(answer.status, [*kept, ("Content-Length", length or "0")], data)
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
    with subprocess.Popen([sys.executable, "-c", SERVER], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
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
    made = http.client.HTTPConnection("127.0.0.1", behind)
    made.request("PUT", f"/{between.bucket}")
    assert made.getresponse().status == 200
    made.close()
    yield between
    between.shutdown()
    between.server_close()


@pytest.fixture
def url(service):
    return f"s3://{service.bucket}/deep/store"


def test_what_a_place_promises_a_bucket_keeps(url):
    place = Store.at(url).place
    assert (place.get("x"), place.size("x"), place.tail("x", 9), place.part("x", 0, 3), place.names("")) == (None,) * 4 + ([],)
    assert place.modified("x") == 0
    place.remove("x")
    place.put("a/b.json", b"hello")
    place.put("a/c/d", b"")
    assert (place.get("a/b.json"), place.size("a/b.json"), place.part("a/b.json", 1, 3)) == (b"hello", 5, b"el")
    assert (place.tail("a/b.json", 2), place.tail("a/b.json", 99)) == ((b"lo", 5), (b"hello", 5))
    assert place.tail("a/c/d", 9) == (b"", 0)
    assert (place.names(""), place.names("a")) == (["a"], ["b.json", "c"])
    assert abs(place.modified("a/b.json") - time.time()) < 600
    place.put("a/b.json", b"other")
    assert place.get("a/b.json") == b"other"
    place.remove("a")
    assert place.names("") == []


def test_run_into_a_bucket_is_up_to_date_afterwards_and_sound(toys, url, service, tmp_path):
    service.pause, service.refuse_every = 0.002, 9
    toys.run(store=str(tmp_path / "calm"))
    assert len(toys.run(store=url).ran) == 40
    assert service.refused > 10
    assert toys.run(store=url).ran == set()
    assert toys.artifacts(store=url) == toys.artifacts(store=str(tmp_path / "calm"))
    store = Store.at(url)
    assert verify(store, [toys.module.GRAPH]).is_sound
    assert store.place.names("records") == []
    toys.run(store=url, intervals={"length": 3})
    assert len(collect(store).records) == 14
    assert toys.run(store=url, intervals={"length": 3}).ran == set()
    assert not (toys.output / "store").exists()


def test_two_runs_at_once_share_a_bucket(toys, url, service, tmp_path):
    service.pause = 0.002
    toys.flag("wait-points-10")
    runs = [
        toys.start("run", str(toys.yaml()), "--output", str(tmp_path / f"out{n}"), "--store", url, "--quiet") for n in (1, 2)
    ]
    toys.until(lambda: toys.executions().count("points-10") == 2, "both compute the first frame", *runs)
    (toys.flags / "wait-points-10").unlink()
    for run in runs:
        _, err = run.communicate(timeout=120)
        assert run.returncode == 0, err
    assert toys.run(store=url).ran == set()


def test_credentials_are_neither_stored_nor_printed(toys, url, service, tmp_path):
    told = toys.command("run", str(toys.yaml()), "--store", url, "--until", "points")
    assert told.returncode == 0, told.stderr
    place = Store.at(url).place
    objects = [o["path"] for chunk in place._store.list("deep/store/") for o in chunk]
    assert len(objects) > 6
    stored = b"".join(place.get(key.removeprefix("deep/store/")) for key in objects)
    left = b"".join(p.read_bytes() for p in toys.output.rglob("*") if p.is_file())
    assert SECRET.encode() not in stored + left + (told.stdout + told.stderr).encode()


def test_bucket_that_is_not_there_is_refused_in_words(service):
    with pytest.raises(StoreError) as refused:
        Store.at("s3://no-such-bucket/store").create()
    assert str(refused.value).startswith("store s3://no-such-bucket/store: cannot ")
    assert "AWS_ENDPOINT_URL" in str(refused.value)
    assert SECRET not in str(refused.value)
