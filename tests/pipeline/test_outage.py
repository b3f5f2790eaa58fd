"""A service of buckets that fails or is gone, against one that refuses: errors, exit codes, what the next run finds."""

import importlib
import signal
import ssl
import subprocess
import sys
import threading
from datetime import timedelta
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer

import numpy as np
import pytest

from kinetree.errors import InputError, ServiceError, StoreError
from kinetree.pipeline.command_line import cli
from kinetree.pipeline.storage import bucket
from kinetree.pipeline.storage.remote import listed_files
from kinetree.pipeline.storage.store import Store


@pytest.fixture
def url(service, monkeypatch):
    """A store's address; what fails is asked once more, at once."""
    monkeypatch.setattr(bucket, "RETRIES", {"max_retries": 1, "retry_timeout": timedelta(seconds=30)})
    return f"s3://{service.bucket}/store"


QUESTIONS = {
    "get": lambda place: place.get("a"),
    "tail": lambda place: place.tail("a", 1),
    "put": lambda place: place.put("a", b"x"),
    "look": lambda place: place.look("a"),
    "names": lambda place: place.names(""),
    "listed": lambda place: place.listed(""),
    "remove": lambda place: place.remove("a"),
}


@pytest.mark.parametrize("question", QUESTIONS)
def test_service_that_fails_is_told_from_one_that_refuses(url, service, question):
    place = Store.at(url).place
    place.put("a", b"x")
    service.refuse_every = 1
    for status in (500, 503, 429):
        service.status = status
        with pytest.raises(ServiceError, match=rf"the service answers {status}, also when asked again; .* then run again"):
            QUESTIONS[question](place)
    for status in (400, 401, 403):
        service.status = status
        with pytest.raises(StoreError, match="the credentials in the environment") as refused:
            QUESTIONS[question](place)
        assert not isinstance(refused.value, ServiceError)


def test_service_that_is_gone_does_not_answer(url, monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
    with pytest.raises(ServiceError, match="the service does not answer"):
        Store.at(url)


def test_name_that_nobody_has_may_be_known_later(url, monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", "https://bucket.nowhere.invalid")
    with pytest.raises(ServiceError, match="no machine of the service's name is found, also when asked again"):
        Store.at(url)


@pytest.fixture
def untrusted(tmp_path):
    """The address of a server on this machine whose certificate nobody signed but itself."""
    key, certificate = tmp_path / "key.pem", tmp_path / "certificate.pem"
    command = ["openssl", "req", "-x509", "-newkey", "rsa:2048", "-nodes", "-days", "1", "-subj", "/CN=localhost"]
    command += ["-addext", "subjectAltName=IP:127.0.0.1", "-keyout", str(key), "-out", str(certificate)]
    subprocess.run(command, check=True, capture_output=True)
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(certificate, key)
    server = ThreadingHTTPServer(("127.0.0.1", 0), QuietHandler)
    server.socket = context.wrap_socket(server.socket, server_side=True)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    yield f"https://127.0.0.1:{server.server_port}"
    server.shutdown()
    server.server_close()


class QuietHandler(BaseHTTPRequestHandler):
    def log_message(self, *_):
        pass


def test_certificate_that_is_not_trusted_is_no_outage(url, untrusted, monkeypatch):
    monkeypatch.setenv("AWS_ENDPOINT_URL", untrusted)
    with pytest.raises(StoreError, match="certificate is not trusted on this machine; check AWS_ENDPOINT_URL") as refused:
        Store.at(url)
    assert not isinstance(refused.value, ServiceError)


def test_array_that_cannot_be_asked_for_is_not_damaged(toys, url, service):
    store = Store.at(url)
    large = toys.module.Points(x=np.random.default_rng(0).normal(size=100_000))  # more than is read at a first look
    points = store.read(toys.module.Points, store.publish(large)[0])
    service.refuse_every = 1
    with pytest.raises(ServiceError):
        points.x  # noqa: B018 - reading it is what is tried
    service.refuse_every = 0
    assert points.x.shape == (100_000,)


@pytest.mark.parametrize(("moment", "executor"), [(40, "threads"), (120, "sync")])
def test_outage_ends_a_run_and_the_next_one_goes_on(toys, url, service, executor, moment):
    service.refuse_from = moment
    compute = {"executor": executor, "workers": 2}
    with pytest.raises(ServiceError):
        toys.run(store=url, compute=compute)
    service.refuse_from = None
    toys.run(store=url, compute=compute)
    assert toys.artifacts(store=url) == toys.artifacts(**calm(toys))


def calm(toys):
    """The blocks of a run that nothing disturbs."""
    blocks = {"store": str(toys.folder / "calm")}
    toys.run(**blocks)
    return blocks


def test_input_that_cannot_be_asked_for_is_not_wrong(toys, url, service):
    service.refuse_every = 1
    with pytest.raises(ServiceError, match="^input s3://"):
        listed_files(f"s3://{service.bucket}/scans/")
    service.status = 403
    with pytest.raises(InputError, match="the credentials in the environment") as refused:
        listed_files(f"s3://{service.bucket}/scans/")
    assert not isinstance(refused.value, ServiceError)


@pytest.mark.parametrize(("status", "code"), [(500, 3), (503, 3), (403, 2)])
def test_exit_code_says_whether_trying_again_may_help(toys, url, service, monkeypatch, capsys, status, code):
    toy = importlib.import_module(f"{toys.name}.__main__").TOY
    monkeypatch.setattr(signal, "signal", lambda *_: None)  # the test's own process keeps its handlers
    monkeypatch.setattr(sys, "argv", ["toy", "run", str(toys.yaml()), "--store", url, "--quiet"])
    service.refuse_every, service.status = 1, status
    with pytest.raises(SystemExit) as end:
        cli.main(toy)
    message = capsys.readouterr().err
    assert (end.value.code, message.startswith(f"toy: store {url}: cannot ")) == (code, True)
    assert "Traceback" not in message
