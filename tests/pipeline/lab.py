"""A laboratory of toy takes: a folder of sequences, and the file that describes them as one data set."""

import importlib
import json
import os
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pipeline.conftest import Toys

from kinetree.pipeline.application import Application, Shortcut
from kinetree.pipeline.dataset.dataset import Dataset


@dataclass
class Lab:
    """Takes in a folder, and the file that describes them."""

    toys: Toys
    takes: Path
    file: Path

    @staticmethod
    def of(toys: Toys) -> "Lab":
        """Three takes of two and three frames."""
        home = toys.folder.parent / "lab"
        lab = Lab(toys, home / "takes", home / "lab.yaml")
        lab.take("a", 10, 20)
        lab.take("b", 30, 40, 50)
        lab.take("c", 60, 70)
        return lab.write()

    @property
    def results(self) -> Path:
        """The folder above the sequences' own."""
        return self.file.parent / "results"

    def take(self, name: str, *numbers: float) -> Path:
        """Writes one frame per number; they look old, so that their digests are remembered."""
        folder = self.takes / name
        folder.mkdir(parents=True, exist_ok=True)
        for frame, number in enumerate(numbers):
            (folder / f"{frame:05d}.txt").write_text(f"{number}")
        for file in folder.iterdir():
            os.utime(file, (time.time() - 100,) * 2)
        return folder

    def write(self, **keys: Any) -> "Lab":
        """Writes the file; None leaves a key out."""
        blocks = {"sequences": "takes/*", "output": "results/{name}", "compute": {"executor": "sync"}, **keys}
        self.file.write_text(json.dumps({key: value for key, value in blocks.items() if value is not None}))
        return self

    def dataset(self) -> Dataset:
        """The data set in this process."""
        return Dataset.of(self.file, application=self.application())

    def application(self) -> Application:
        """The product of toys in this process."""
        return Application(
            "toy",
            "Adds numbers.",
            lambda: {"toy": self.toys.module.GRAPH},
            shortcuts=(Shortcut(("--input",), "source.input", "", is_input=True),),
            data_sets=lambda: importlib.import_module(f"{self.toys.name}.toy_datasets").GRAPH,
        )

    def run(self, **options: Any) -> dict[str, Any]:
        """Runs in this process; what was executed before is forgotten."""
        self.toys.clear()
        return self.dataset().run(**options)

    @staticmethod
    def states(record: dict[str, Any]) -> dict[str, str]:
        """What a run did with each sequence."""
        return {name: row["state"] for name, row in record["sequences"].items()}

    def summary(self) -> dict[str, float | None]:
        """What the summary holds."""
        return dict(json.loads((self.results / "summary.json").read_text()))

    def last_run(self) -> dict[str, Any]:
        """What the last run left."""
        return dict(json.loads((self.results / "dataset.json").read_text()))
