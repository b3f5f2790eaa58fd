"""How connections to dask's scheduler and workers are secured, and closed."""

import contextlib
import ssl
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from distributed import Security
from distributed.comm import parse_address

from kinetree.errors import ConfigError
from kinetree.pipeline.settings.config import Compute

_FILES = ("_file", "_cert", "_key")
"""How the arguments of distributed.Security end that name files."""
_ENCRYPTED = ("tls", "wss")
_ROLES = ("scheduler", "worker", "client")
_CLIENT = "tls_ca_file, tls_client_cert, tls_client_key"
"""The arguments of distributed.Security that a client needs."""


@contextlib.contextmanager
def closed(opened: Any) -> Iterator[Any]:
    """Closes a client or a cluster; one that does not stop in time ends with this process and is no fault of the run."""
    try:
        yield opened
    finally:
        with contextlib.suppress(OSError, RuntimeError, TimeoutError):
            opened.close()


def secured(compute: Compute, scheduler: str = "") -> dict[str, Security]:
    """The argument of dask's classes that secures their connections, if the configuration names one; raises ConfigError.

    scheduler : how the configuration names one that somebody else runs; empty where the run starts its own
    """
    wanted = compute.security
    if not wanted:
        return {}
    if wanted == "temporary":
        if scheduler:
            raise ConfigError(f"compute.security temporary: {scheduler} has certificates of its own; name them: {_CLIENT}")
        try:
            return {"security": Security.temporary()}
        except ImportError:
            raise ConfigError("compute.security temporary: cryptography is not installed; pip install cryptography") from None
    files = {key: str(path) for key, path in wanted.items() if key.endswith(_FILES)}
    if missing := [f"{key} {path}" for key, path in files.items() if not Path(path).is_file()]:
        raise ConfigError(f"compute.security: {missing[0]}: there is no such file")
    try:
        security = Security(**{**wanted, "require_encryption": True})
    except (TypeError, ValueError) as error:
        raise ConfigError(f"compute.security: {error}") from None
    if compute.has_own_workers:
        _refuse_without_certificates(security)
    return {"security": security}


def _refuse_without_certificates(security: Security) -> None:
    """Raises ConfigError where the scheduler, the workers or the client that a run starts itself would have no certificate."""
    try:
        missing = [role for role in _ROLES if security.get_connection_args(role)["ssl_context"] is None]
    except (ssl.SSLError, OSError) as error:
        raise ConfigError(f"compute.security: the certificates cannot be loaded ({error}); expected PEM") from None
    if missing:
        named = f"tls_ca_file, tls_{missing[0]}_cert, tls_{missing[0]}_key"
        raise ConfigError(f"compute.security: the {missing[0]} has no certificate; name {named}, or say temporary")


def refuse_unfit(address: str, security: Security, asked: str) -> None:
    """Raises ConfigError where a client can say without asking anybody that it cannot connect like this.

    asked : how the configuration names the scheduler
    """
    scheme, _ = parse_address(address)
    if security.require_encryption and scheme not in _ENCRYPTED:
        raise ConfigError(f"{asked}: {address} is not encrypted, but encryption is asked for; expected tls://host:8786")
    if scheme not in _ENCRYPTED:
        return
    try:
        context = security.get_connection_args("client")["ssl_context"]
    except (ssl.SSLError, OSError) as error:
        raise ConfigError(f"compute.security: the certificates cannot be loaded ({error}); expected PEM: {_CLIENT}") from None
    if context is None:
        raise ConfigError(f"{asked}: {address} is secured by TLS; name certificates in compute.security: {_CLIENT}")
