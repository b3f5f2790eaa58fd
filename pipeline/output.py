"""What a run leaves in its output folder beside its results: run.json and the configuration that made them."""

import json
from pathlib import Path
from typing import Any

import yaml

from kinetree.pipeline.blocks import SAVED
from kinetree.pipeline.config import Config
from kinetree.pipeline.place import Folder

RUN_JSON = "run.json"


def write_config(config: Config) -> None:
    """Leaves the configuration, so that every command can name the output folder instead of the file."""
    head = "# The configuration of the last run into this folder; what is not here is the default.\n"
    _write(config.output, SAVED, head + as_yaml(config.saved()))


def as_yaml(saved: dict[str, Any]) -> str:
    """YAML that is read back as the same: in the user's own letters, or in escapes where a line separator is among them."""
    text = yaml.safe_dump(saved, sort_keys=False, allow_unicode=True)
    return text if yaml.safe_load(text) == saved else yaml.safe_dump(saved, sort_keys=False)


def write_run_json(config: Config, told: dict[str, Any]) -> None:
    """Leaves what ran, what was fresh, what failed."""
    _write(config.output, RUN_JSON, json.dumps(told, indent=2, ensure_ascii=False) + "\n")


def _write(folder: Path, name: str, text: str) -> None:
    Folder(folder, "output folder", beside="").put(name, text.encode("utf-8", "backslashreplace"))
