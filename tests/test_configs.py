"""The presets that ship with kinetree."""

from pathlib import Path

import pytest
import yaml

from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.settings.blocks import Reading
from kinetree.pipeline.settings.config import Compute, checked
from kinetree.pipeline.settings.explain import explained
from kinetree.tasks.application import APPLICATION

CONFIGS = Path(__file__).resolve().parent.parent / "configs"


def test_default_yaml_tells_every_default() -> None:
    default = Pipeline.of()
    is_told = (CONFIGS / "default.yaml").read_text().endswith(explained(default.config, default.tasks))
    assert is_told, "configs/default.yaml is stale; below its first line stands what `kinetree config` prints"


@pytest.mark.parametrize("name", Reading.of({}, APPLICATION.presets).preset_names)
def test_every_preset_is_a_configuration(name: str) -> None:
    methods = {
        "paper-2014": "mesoscopic-2014",
        "paper-2014-aligned": "mesoscopic-2014-aligned",
        "paper-2009": "reeb-2009",
    }
    assert Pipeline.of(name).config.method == methods.get(name, "mesoscopic")


@pytest.mark.parametrize("path", sorted(CONFIGS.glob("compute/*.yaml")), ids=lambda path: path.stem)
def test_every_compute_preset_is_one(path: Path) -> None:
    told = yaml.safe_load(path.read_text())
    assert Pipeline.of({"compute": path.stem}).config.compute == checked(Compute, told, path.name)


def test_configuration_printed_in_full_is_read_back_as_the_same() -> None:
    here = Pipeline.of({"mesh": {"component_share": 0.25}, "sequence": {"fps": 12.5}})
    again = Pipeline.of(yaml.safe_load(explained(here.config, here.tasks)))
    assert again.config.params == here.config.params
