"""Configuration: one block of parameters per task, and what cannot change a result (output, store, compute) beside them.

A value comes from, last wins: the schema's default, the preset a file `extends`, the file, `--set task.name=value`.
"""

import os
import re
import reprlib
import typing
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator

from kinetree.errors import ConfigError
from kinetree.pipeline.application import Application
from kinetree.pipeline.settings.blocks import Reading, block, blocks_at, compute_block, expanded, is_output, override, portable
from kinetree.pipeline.settings.option import as_typed
from kinetree.pipeline.storage.store import MARKER
from kinetree.pipeline.suggest import nearest
from kinetree.schemas.array import Params

M = TypeVar("M", bound=BaseModel)
BUCKET = "s3://"
SCHEME = re.compile(r"(?:.*/)?[A-Za-z][A-Za-z0-9+.-]+:(?=/)")
"""What an address begins with, also one that was taken for the path of a folder; a drive has one letter."""
"""How the address of a bucket begins, which may take the place of the store's folder."""
RUN_KEYS = ("extends", "method", "output", "store", "compute")


WAIT_SECONDS = 300.0
"""How long a run goes on without any worker."""


class Compute(BaseModel):
    """Where and how wide a run is computed; never part of a key."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    executor: Literal["sync", "threads", "processes"] = "threads"
    """sync: in this thread, for debugging; threads: in this process; processes: worker processes of this machine."""
    workers: int | None = Field(default=None, ge=1, le=4096)
    """How many at the same time; None takes one per core."""
    memory: str | None = None
    """Memory limit of one worker process, e.g. 4GB; None sets none. With `cluster`: what its workers declare as dask's resource
    `memory`."""
    scheduler: str | None = Field(default=None, min_length=1)
    """Address of a running dask scheduler, e.g. tcp://host:8786; takes precedence over executor."""
    scheduler_file: str | None = Field(default=None, min_length=1)
    """File in which a running dask scheduler left its address; takes precedence over executor."""
    wait_workers: str | None = Field(default=None, pattern=r"^[1-9][0-9]*(,[0-9]+(\.[0-9]+)?)?$")
    """Workers to wait for before anything is computed, and for how many seconds at most, e.g. 4,600; default: as they come, and
    300 s without any before the run gives up."""
    cluster: str | None = Field(default=None, pattern=r"^[\w.]+:\w+$")
    """Class that starts workers, as module:class, e.g. dask_jobqueue:SLURMCluster; takes precedence over executor."""
    options: dict[str, Any] = {}
    """What that class is called with."""
    adapt: tuple[int, int] | None = None
    """Fewest and most workers of that class, which come and go with the work; None takes as many as `workers` says."""
    security: Literal["temporary"] | dict[str, bool | str] = {}
    """TLS between client, scheduler and workers: arguments of distributed.Security such as tls_ca_file, tls_client_cert and
    tls_client_key (require_encryption is always true), or temporary: certificates of workers that the run starts itself. By
    default what dask is configured to."""
    performance_report: str | None = Field(default=None, exclude=True)
    """File for dask's own report on a run."""

    @field_validator("memory")
    @classmethod
    def _is_a_size(cls, size: str | None) -> str | None:
        if size is not None and not re.fullmatch(r"[0-9]{1,15}(\.[0-9]{1,15})? ?([kMGT]i?)?B", size):
            raise ValueError("expected a size such as 4GB or 512MiB")
        return size

    @field_validator("security")
    @classmethod
    def _is_encrypted(cls, security: Any) -> Any:
        for key, value in security.items() if isinstance(security, Mapping) else ():
            if key == "require_encryption" and value is not True:
                raise ValueError("require_encryption: what it sets up is always encrypted; expected true or nothing")
            if key != "require_encryption" and not isinstance(value, str):
                raise ValueError(f"{key}: expected a text")
        return security

    @property
    def is_here(self) -> bool:
        """Whether this machine computes, in this process or in processes of its own."""
        return self.scheduler is None and self.scheduler_file is None and self.cluster is None

    @property
    def has_own_workers(self) -> bool:
        """Whether processes that the run starts on this machine compute."""
        return self.executor == "processes" and self.is_here

    @property
    def memory_bytes(self) -> int | None:
        """The memory limit of one worker process in bytes."""
        if self.memory is None:
            return None
        unit = self.memory.lstrip("0123456789. ").removesuffix("B")
        step = 1024 if unit.endswith("i") else 1000
        return int(float(self.memory[: -len(unit) - 1]) * step ** " kMGT".index((unit or " ")[0]))

    @property
    def is_cluster(self) -> bool:
        """Whether nodes are computed by workers of dask and not in this process."""
        return self.executor == "processes" or any((self.scheduler, self.scheduler_file, self.cluster))

    @property
    def wanted_workers(self) -> tuple[int, float]:
        """Workers to wait for, and seconds to wait for them or for any."""
        count, _, seconds = (self.wait_workers or "0").partition(",")
        return int(count), float(seconds or WAIT_SECONDS)

    @property
    def worker_count(self) -> int:
        """Workers to start on this machine."""
        return self.workers or len(os.sched_getaffinity(0))


@dataclass(frozen=True)
class Origins:
    """Where the values of a configuration come from, as messages name it."""

    file: str
    """The file, the preset or whatever the blocks were read from."""
    blocks: frozenset[Any]
    """The keys at the top of it."""
    options: Mapping[str, str]
    """What was typed on the command line by the parameter that it sets."""

    def of(self, *keys: str) -> str:
        """The option that set the value at the keys, above or below them; where none did, the file."""
        above = [".".join(keys[:depth]) for depth in range(len(keys), 0, -1)]
        origin = next((self.options[key] for key in above if key in self.options), None)
        if origin is None and (len(keys) > 1 or keys[0] not in self.blocks):
            origin = next((option for key, option in self.options.items() if key.startswith(f"{above[0]}.")), None)
        return origin or self.file


@dataclass(frozen=True)
class Config:
    """A checked configuration; `params` has an entry for every task that has parameters."""

    method: str
    params: Mapping[str, Params]
    output: Path
    store: Path | str
    """A folder, or the address of a bucket."""
    compute: Compute
    is_left: bool = field(default=False, compare=False)
    """Whether an earlier run left it in its output folder, which was named."""

    def saved(self) -> dict[str, Any]:
        """What differs from the defaults, as the YAML a run leaves in its output folder; paths are absolute."""
        saved: dict[str, Any] = {"method": self.method, "output": str(self.output), "store": str(self.store)}
        for name, params in self.params.items():
            changed = params.model_dump(mode="json", exclude_defaults=True)
            if changed:
                saved[name] = changed
        compute = self.compute.model_dump(mode="json", exclude_defaults=True)
        return {**saved, "compute": compute} if compute else saved

    def portable(self) -> dict[str, Any]:
        """The same with the paths below and beside the output folder relative to it, so that they may move together."""
        return portable(self.saved(), self.output, {name: params.path_fields() for name, params in self.params.items()})


def load(target: str | Path | Mapping[str, Any] | None, application: Application, sets: Iterable[str] = ()) -> Config:
    """The configuration at `target`: a YAML file, a preset's name, an earlier run's output folder, a mapping, or nothing.

    application : whose graphs, presets and default output folder they are
    sets   : overrides as task.name=value, the value in YAML
    raises : ConfigError, naming file and key, with the nearest known key
    """
    methods = application.methods()
    reading = Reading.of(methods, application.presets)
    blocks, where = blocks_at(target, reading)
    sets = tuple(sets)
    origins = Origins(where, frozenset(blocks), {text.partition("=")[0].strip(): as_typed(text) for text in sets})
    for text in sets:
        override(blocks, text, reading.paths)
    return resolved(blocks, origins, application, reading, is_left=is_output(target))


def resolved(
    blocks: Mapping[str, Any], origins: Origins, application: Application, reading: Reading, *, is_left: bool = False
) -> Config:
    """The checked configuration that blocks with absolute paths make; raises as `load`."""
    methods = application.methods()
    method = _method(blocks, methods, origins)
    known = {task.name: task.sets for task in methods[method].tasks if task.sets is not None}
    _refuse_unknown(blocks, {*known, *RUN_KEYS}, application.renamed, origins)
    params = {name: checked(cls, block(blocks, name), name, origins, application.renamed) for name, cls in known.items()}
    output = _folder(blocks, "output", origins) or Path(f"{application.name}-output").absolute()
    address = blocks.get("store")
    store: Path | str = output / "store"
    if isinstance(address, str) and address.startswith(BUCKET):
        store = address
    else:
        store = _folder(blocks, "store", origins) or store
    _refuse_own_input(params, output, origins.file)
    _refuse_stores(output, store, origins.of("output"))
    compute = checked(Compute, compute_block(blocks, reading), "compute", origins)
    return Config(method, params, output, store, compute, is_left)


def _method(blocks: Mapping[str, Any], methods: Iterable[str], origins: Origins) -> str:
    """The method that the blocks name, or the first there is."""
    method = blocks.get("method", next(iter(methods)))
    if not isinstance(method, str) or method not in methods:
        raise ConfigError(f"{origins.of('method')}: method {method!r}: no such method; {nearest(str(method), methods)}")
    return method


def _refuse_own_input(params: Mapping[str, Params], output: Path, where: str) -> None:
    """Results among the user's own files would be lost in them, and a glob would read them as input."""
    for name, block_params in params.items():
        for keys in block_params.path_fields():
            value: Any = block_params
            for key in keys:
                value = getattr(value, key, None)
            if value and Path(value).absolute() == output:
                raise ConfigError(f"{where}: output {output} is also {'.'.join((name, *keys))}; name a folder of its own")


def _refuse_stores(output: Path, store: Path | str, where: str) -> None:
    """A store holds nothing but its own; what a run leaves among its files would be in the way of both."""
    for folder in (output, *output.parents):
        if folder == store or os.access(folder / MARKER, os.F_OK):
            raise ConfigError(f"{where}: output {output} lies in the store {folder}; name a folder outside of it")


def with_compute(config: Config, **changes: Any) -> Config:
    """The configuration with some of its compute settings replaced; None leaves one as it is."""
    return replace(config, compute=with_changes(config.compute, **changes))


def with_changes(compute: Compute, **changes: Any) -> Compute:
    """Compute settings of which some are replaced; None leaves one as it is; raises ConfigError."""
    changed = {k: v for k, v in changes.items() if v is not None}
    if "executor" in changed:
        changed.update({name: changed.get(name) for name in ("scheduler", "scheduler_file", "cluster")})
        # a scheduler that only the file names gives way to what is asked for now
    return checked(Compute, {**compute.model_dump(), **changed}, "compute")


def checked(
    cls: type[M], values: Any, name: str, origins: Origins | None = None, renamed: Mapping[str, str] = MappingProxyType({})
) -> M:
    """The values as a model of `cls`; raises ConfigError that names the key, what was given and the nearest known key.

    name    : of the block
    origins : where its values come from; None where only the name is to stand in the message
    renamed : what parameters that have another name now are called, as task.name
    """

    def at(*keys: str) -> str:
        return name if origins is None else f"{origins.of(name, *keys)}: {name}"

    if not isinstance(values, Mapping):
        raise ConfigError(f"{at()}: expected keys with values, got {_short(values)}")
    try:
        return cls.model_validate(dict(values))
    except ValidationError as error:
        lines = []
        for fault in error.errors():
            keys = [str(part) for part in fault["loc"]]
            new_name = renamed.get(".".join([name, *keys]), "")
            lines.append(f"{at(*keys)}.{'.'.join(keys)}: {_fault(cls, fault, new_name)}")
        raise ConfigError("\n".join(lines)) from None


def _fault(cls: type[BaseModel], fault: Any, new_name: str) -> str:
    """What is wrong with a key and what to do; `new_name` is what it is called now, "" where it was never renamed."""
    if fault["type"] == "extra_forbidden":
        return f"no such key; {_instead(str(fault['loc'][-1]), _keys_at(cls, fault['loc'][:-1]), new_name)}"
    what = fault["msg"].removeprefix("Value error, ")
    return f"{what[:1].lower()}{what[1:]}, got {_short(fault['input'])}"


def _keys_at(cls: type[BaseModel], place: Iterable[str | int]) -> Iterable[str]:
    """The keys of the model that lies at a place within another."""
    for part in place:
        waiting: list[Any] = [cls.model_fields[part].annotation] if part in cls.model_fields else []
        while waiting:
            kind = waiting.pop()
            if isinstance(kind, type) and issubclass(kind, BaseModel):
                cls = kind
                break
            waiting.extend(typing.get_args(kind))
    return cls.model_fields


def _folder(blocks: Mapping[str, Any], key: str, origins: Origins) -> Path | None:
    path, where = blocks.get(key), origins.of(key)
    if path is None:
        return None
    if not isinstance(path, str) or not path:
        raise ConfigError(f"{where}: {key}: expected the path of a folder, got {_short(path)}; put it in quotes if it is one")
    if "://" in path:
        raise ConfigError(f"{where}: {key}: {path} is the address of a service, which is not supported; give a folder")
    scheme = SCHEME.match(path)
    if scheme and not os.access(expanded(scheme[0]), os.F_OK):
        raise ConfigError(
            f"{where}: {key}: {path} looks like the address of a service, which is not supported; give a folder, and make"
            f" {scheme[0]} first if it is one"
        )
    return expanded(path).absolute()


def _short(value: Any) -> str:
    """A value as a message can quote it: nested aliases can stand for more than memory holds."""
    quoting = reprlib.Repr()
    quoting.maxstring = quoting.maxother = 200
    return quoting.repr(value)


def _refuse_unknown(blocks: Mapping[str, Any], known: Collection[str], renamed: Mapping[str, str], origins: Origins) -> None:
    for key in blocks:
        if key not in known:
            new_name = renamed.get(str(key), "")
            new_name = new_name if new_name in known else ""  # of another method
            raise ConfigError(f"{origins.of(str(key))}: no such key {key!r}; {_instead(str(key), known, new_name)}")


def _instead(name: str, known: Iterable[str], new_name: str) -> str:
    """What to write in place of an unknown key."""
    return f"it is now {new_name!r}" if new_name else nearest(name, known)
