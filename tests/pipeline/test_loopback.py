"""The trust boundary: what this machine's workers listen on, and TLS where it is asked for."""

import ipaddress
import json
import os
import re
import socket
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import dask
import pytest
from distributed import Client, LocalCluster, Security

from kinetree.errors import ClusterError, ConfigError
from kinetree.pipeline.running import clusters
from kinetree.pipeline.running.own_cluster import local
from kinetree.pipeline.settings.config import Compute

_LISTENING = "0A"


def family(process: int) -> Iterator[int]:
    """A process and all that it started."""
    yield process
    for task in Path(f"/proc/{process}/task").glob("*/children"):
        for child in task.read_text().split():
            yield from family(int(child))


def listening(process: int) -> set[str]:
    """Addresses at which a process and its children accept TCP connections."""
    inodes = set()
    for one in family(process):
        for handle in Path(f"/proc/{one}/fd").glob("*"):
            try:
                target = str(handle.readlink())
            except OSError:
                continue
            if target.startswith("socket:["):
                inodes.add(target[8:-1])
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            if words[3] == _LISTENING and words[9] in inodes:
                raw = bytes.fromhex(words[1].partition(":")[0])
                turned = b"".join(raw[i : i + 4][::-1] for i in range(0, len(raw), 4))
                found.add(str(ipaddress.ip_address(turned)))
    return found


@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="no /proc")
def test_workers_of_this_machine_listen_on_loopback_alone():
    with local(Compute(workers=1)) as client:
        assert client.submit(abs, -1).result(timeout=60) == 1
        there = listening(os.getpid())
    assert there
    assert [address for address in there if not ipaddress.ip_address(address).is_loopback] == []


def test_a_socket_for_everybody_would_be_noticed():
    with socket.create_server(("0.0.0.0", 0)):
        assert "0.0.0.0" in listening(os.getpid())


def test_temporary_certificates_secure_the_workers_and_strangers_are_turned_away():
    with local(Compute(workers=1, security="temporary")) as client:
        address = client.scheduler.address
        assert address.startswith("tls://127.0.0.1:")
        assert client.submit(abs, -1).result(timeout=60) == 1
        with pytest.raises((OSError, TimeoutError)):
            Client(address, security=Security.temporary(), timeout=2)
        with pytest.raises((OSError, TimeoutError)):
            Client(address.replace("tls://", "tcp://"), timeout=2)


@pytest.fixture
def certificates(tmp_path):
    """Those of two authorities, as files: the arguments of distributed.Security, and the authority of the first alone."""

    def written(folder):
        folder.mkdir()
        made, files = Security.temporary(), {}
        for key in ("tls_ca_file", "tls_client_cert", "tls_client_key"):
            (folder / key).write_text(getattr(made, key))
            files[key] = str(folder / key)
        return made, files

    made, right = written(tmp_path / "right")
    broken = tmp_path / "broken.pem"
    broken.write_text("no certificate")
    _, strange = written(tmp_path / "strange")
    authority = {"tls_ca_file": right["tls_ca_file"]}
    half = {**right, "tls_ca_file": strange["tls_ca_file"]}
    return made, {
        "right": right,
        "none": {},
        "authority": authority,
        "strange": strange,
        "half": half,
        "broken": {**right, "tls_client_cert": str(broken)},
    }


@pytest.fixture
def secured(certificates):
    """The address of a scheduler with certificates that has a worker."""
    where = {"processes": False, "dashboard_address": "127.0.0.1:0"}
    with LocalCluster(n_workers=1, security=certificates[0], **where) as cluster:
        yield cluster.scheduler_address


@pytest.mark.parametrize("also", [{}, {"require_encryption": True}])
def test_a_scheduler_with_certificates_is_reached_with_them(toys, certificates, secured, tmp_path, also):
    file = tmp_path / "scheduler.json"
    file.write_text(json.dumps({"address": secured}))
    compute = {"scheduler_file": str(file), "security": {**certificates[1]["right"], **also}}
    assert toys.run(until=("smooth",), compute=compute).told["status"] == "done"


@pytest.mark.parametrize(
    ("files", "scheme", "words"),
    [
        (
            "none",
            "tls",
            "is secured by TLS; name certificates in compute.security: tls_ca_file, tls_client_cert",
        ),
        ("authority", "tls", "is secured by TLS; name certificates in compute.security"),
        ("right", "tcp", r"is not encrypted, but encryption is asked for; expected tls://host:8786"),
        ("broken", "tls", "compute.security: the certificates cannot be loaded .*; expected PEM"),
        ("strange", "tls", "the certificates of the two sides do not fit .*; see compute.security"),
        ("half", "tls", "the certificates of the two sides do not fit .*; see compute.security"),
    ],
)
def test_certificates_that_do_not_fit_are_the_users_to_mend(certificates, secured, files, scheme, words):
    compute = Compute(scheduler=secured.replace("tls://", f"{scheme}://"), security=certificates[1][files])
    with pytest.raises(ConfigError, match=words), clusters.at(compute):
        pass


def test_somebody_who_speaks_no_tls_is_a_fault_of_the_cluster_and_leaves_no_client(certificates):
    """In a process of its own: tornado leaves sockets open where it cannot secure them."""
    script = [sys.executable, str(Path(__file__).parent / "no_tls.py"), json.dumps(certificates[1]["right"])]
    answers = json.loads(subprocess.run(script, capture_output=True, text=True, check=True).stdout)
    assert len(answers) == 6
    for refusal, says, threads in answers.values():
        assert refusal == "ClusterError"
        assert re.search(r"nobody speaks TLS there .*; check the address", says)
        assert threads == []


@pytest.mark.parametrize("address", ["tcp://host", "tcp://host:port", "host", "nosuch://host:8786", "tcp://[::1"])
def test_what_is_no_address_is_the_users_to_mend(address):
    with pytest.raises(ConfigError, match="not an address"), clusters.at(Compute(scheduler=address)):
        pass


@pytest.mark.parametrize(
    ("files", "words"),
    [
        ({"require_encryption": True}, "the scheduler has no certificate; name tls_ca_file, .* or say temporary"),
        ("right", "the scheduler has no certificate"),
        ("all but the worker's", "the worker has no certificate; name tls_ca_file, tls_worker_cert"),
        ("broken", "the certificates cannot be loaded .*; expected PEM"),
    ],
)
def test_own_workers_without_certificates_are_the_users_to_mend(certificates, files, words):
    right, broken = certificates[1]["right"], certificates[1]["broken"]
    of_scheduler = {key.replace("client", "scheduler"): path for key, path in right.items()}
    named = {"right": right, "all but the worker's": {**right, **of_scheduler}, "broken": {**of_scheduler, **broken}}
    compute = Compute(executor="processes", security=files if isinstance(files, dict) else named[files])
    with pytest.raises(ConfigError, match=f"^compute.security: {words}"), local(compute):
        pass


def test_a_security_loader_that_is_not_there_is_the_users_to_mend():
    with (
        dask.config.set({"distributed.client.security-loader": "nowhere.certificates"}),
        pytest.raises(ConfigError, match=r"security-loader cannot be imported .*nowhere"),
        clusters.at(Compute(scheduler="tcp://127.0.0.1:1")),
    ):
        pass


def test_without_certificates_the_security_loader_of_dask_is_asked(monkeypatch):
    asked = []

    def client(address, timeout, security):
        asked.append((address, security))
        raise OSError("no such scheduler")

    monkeypatch.setattr(clusters, "_ClosedUnlessConnected", client)
    with (
        dask.config.set({"distributed.client.security-loader": "company.certificates"}),
        pytest.raises(ClusterError, match="nobody answers there"),
        clusters.at(Compute(scheduler="tls://127.0.0.1:1")),
    ):
        pass
    assert asked == [("tls://127.0.0.1:1", None)]


@pytest.mark.parametrize(
    ("security", "words"),
    [
        ({"tls_ca_file": "/nowhere/ca.pem"}, "compute.security: tls_ca_file /nowhere/ca.pem: there is no such file"),
        ({"require_encryption": True}, "tcp://127.0.0.1:1 is not encrypted, but encryption is asked for"),
        ({"ca": "x"}, r"compute.security: Unknown parameters: \['ca'\]"),
        ("temporary", "compute.security temporary: --scheduler tcp://127.0.0.1:1 has certificates of its own"),
    ],
)
def test_security_that_cannot_be_is_refused_in_words(security, words):
    compute = Compute(scheduler="tcp://127.0.0.1:1", security=security)
    with pytest.raises(ConfigError, match=words), clusters.at(compute):
        pass
