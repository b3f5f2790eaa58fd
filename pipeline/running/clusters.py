"""Where parcels are computed on dask's distributed scheduler: workers of this machine, or any scheduler's address."""

import asyncio
import contextlib
import importlib
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from distributed import Client, Security, config, performance_report
from distributed.comm import get_address_host
from distributed.comm.core import CommClosedError, FatalCommClosedError

from kinetree.errors import ClusterError, ConfigError
from kinetree.errors.small_text import small_json, small_text
from kinetree.pipeline.running.connections import closed, refuse_unfit, secured
from kinetree.pipeline.running.own_cluster import Configured, local
from kinetree.pipeline.running.own_workers import Starts
from kinetree.pipeline.running.quiet import quiet
from kinetree.pipeline.settings.config import Compute

CONNECT_SECONDS = 10
SCHEDULER_FILE_BYTES = 2**20
NO_TLS = {
    "WRONG_VERSION_NUMBER",
    "RECORD_LAYER_FAILURE",  # the same from OpenSSL 3.2 on
    "PACKET_LENGTH_TOO_LONG",
    "UNEXPECTED_MESSAGE",
    "UNEXPECTED_EOF_WHILE_READING",
}
"""What OpenSSL says of somebody who speaks something else than TLS, or hangs up."""
_NOBODY_SPEAKS_TLS = "nobody speaks TLS there ({}); check the address and the scheduler"


class _ClosedUnlessConnected(Client):  # type: ignore[misc]
    """A client that connects within its time, however little it is answered, and is closed where it cannot connect.

    dask waits for ever for somebody who answers the call and says nothing. Closing it leaves to the garbage collector; where
    this comes while another client starts, it waits for a lock that its own thread has, for ever.
    """

    def __init__(self, *args: Any, **options: Any) -> None:
        try:
            super().__init__(*args, **options)
        except Exception:
            with contextlib.suppress(OSError, RuntimeError, TimeoutError, AttributeError):  # it may be half made
                self.close()
                self._loop_runner.stop()  # dask leaves it running where it has closed the client itself
            raise

    async def _ensure_connected(self, timeout: float | None = None) -> None:
        await asyncio.wait_for(super()._ensure_connected(timeout), timeout)

    def _send_to_scheduler_safe(self, msg: dict[str, Any]) -> None:
        """What was to be sent while the connection broke is lost with the other work, which the run tells when dask has
        noticed; dask raises here, where nobody can catch it, and a page of tornado's log is all that comes of it.
        """
        with contextlib.suppress(CommClosedError):
            super()._send_to_scheduler_safe(msg)


@contextlib.contextmanager
def connected(
    compute: Compute,
    client: Client | None = None,
    configured: Configured = contextlib.nullcontext,
    starts: Starts | None = None,
) -> Iterator[Client]:
    """The client handed in, or one of the cluster that the configuration names; raises ClusterError, ConfigError.

    configured, starts : as in `local`
    """
    with quiet(), contextlib.ExitStack() as stack:
        if client is None and (compute.scheduler or compute.scheduler_file):
            client = stack.enter_context(at(compute))
        elif client is None and compute.cluster:
            client = stack.enter_context(started(compute))
        elif client is None:
            client = stack.enter_context(local(compute, configured, starts))
        if compute.performance_report is not None:
            if find_spec("bokeh") is None:
                raise ConfigError("--performance-report: bokeh is not installed; pip install 'kinetree[cluster]'")
            stack.enter_context(client.as_current())
            stack.enter_context(performance_report(filename=compute.performance_report))
        yield client


@contextlib.contextmanager
def at(compute: Compute) -> Iterator[Client]:
    """A scheduler that somebody else runs; raises ClusterError where none answers, ConfigError where TLS refuses."""
    asked = f"--scheduler {compute.scheduler}" if compute.scheduler else f"--scheduler-file {compute.scheduler_file}"
    with _refusals(asked):
        try:
            address = compute.scheduler or _left_address(Path(str(compute.scheduler_file)))
            get_address_host(address)
        except (ValueError, KeyError, TypeError) as error:
            raise ConfigError(f"{asked}: not an address ({error}); expected one such as tcp://host:8786") from None
        security = secured(compute, asked).get("security")
        if security or not _has_security_loader():
            refuse_unfit(address, security or Security(), asked)
        client = _ClosedUnlessConnected(address, timeout=CONNECT_SECONDS, security=security)
    with closed(client):
        yield client


@contextlib.contextmanager
def _refusals(asked: str) -> Iterator[None]:
    """What dask says where it cannot connect, in words: a fault of the cluster or one of the configuration."""
    try:
        yield
    except FatalCommClosedError as error:
        why = error.__cause__ or error
        if getattr(why, "reason", "") in NO_TLS:
            raise ClusterError(f"{asked}: {_NOBODY_SPEAKS_TLS.format(why)}") from error
        raise ConfigError(f"{asked}: the certificates of the two sides do not fit ({why}); see compute.security") from None
    except UnicodeError as error:
        raise ConfigError(f"{asked}: not an address ({error}); expected one such as tcp://host:8786") from None
    except ValueError as error:  # tornado's, of a connection that was closed before it could be secured
        raise ClusterError(f"{asked}: {_NOBODY_SPEAKS_TLS.format(error)}") from error
    except ImportError as error:
        if not _has_security_loader():
            raise ConfigError(f"{asked}: {error}; install the package that has it") from None
        raise ConfigError(f"{asked}: dask's distributed.client.security-loader cannot be imported ({error})") from None
    except (OSError, TimeoutError) as error:
        raise ClusterError(
            f"{asked}: nobody answers there within {CONNECT_SECONDS} s ({type(error).__name__});"
            " check the address (tls:// where it is secured) and that the scheduler runs (dask scheduler), or leave the"
            " option out"
        ) from error


def _has_security_loader() -> bool:
    """Whether dask's own settings name a function that dask asks for certificates where none are named."""
    return bool(config.get("distributed", {}).get("client", {}).get("security-loader"))


def _left_address(file: Path) -> str:
    """What a scheduler left in its file; raises OSError where the file is not there yet."""
    file.stat()
    scheduler = small_json(small_text(file, ConfigError, SCHEDULER_FILE_BYTES), str(file), ConfigError)
    return str(scheduler["address"])


@contextlib.contextmanager
def started(compute: Compute) -> Iterator[Client]:
    """Workers that a class of the configuration starts, gone when the block ends."""
    with contextlib.ExitStack() as stack:
        cluster = stack.enter_context(closed(cluster_of(compute)))
        if compute.adapt is not None:
            cluster.adapt(minimum=compute.adapt[0], maximum=compute.adapt[1])
        else:
            cluster.scale(compute.workers or 1)
        yield stack.enter_context(closed(Client(cluster)))


def cluster_of(compute: Compute) -> Any:
    """The cluster that a configuration names by class and options; raises ConfigError, ClusterError."""
    module, _, name = str(compute.cluster).partition(":")
    try:
        made = getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError) as error:
        hint = (
            "; pip install 'kinetree[cluster]'"
            if module.split(".")[0] == "dask_jobqueue"
            else "; install the package that has it"
        )
        raise ConfigError(f"compute.cluster {compute.cluster}: {error}{hint if _is_missing(module) else ''}") from None
    try:
        return made(**{**secured(compute), **compute.options})
    except (TypeError, ValueError) as error:
        raise ConfigError(f"compute.cluster {compute.cluster} with compute.options cannot be made: {error}") from None
    except (OSError, RuntimeError) as error:
        raise ClusterError(f"compute.cluster {compute.cluster}: {error}") from error


def _is_missing(module: str) -> bool:
    """Whether the package of a module is not installed."""
    return find_spec(module.split(".")[0]) is None


def dashboard(client: Client) -> str:
    """Address of the dashboard; empty where its scheduler has none."""
    return str(client.dashboard_link or "") if find_spec("bokeh") is not None else ""
