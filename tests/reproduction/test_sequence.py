"""Runs are of the presets and of the sequence that was named, whatever else lies in the current folder."""

from pathlib import Path

import pytest

from kinetree.errors import InputError
from kinetree.pipeline.settings.blocks import SAVED
from kinetree.tasks.application import APPLICATION
from kinetree.tasks.reproduction.sequence import PRESETS, Sequence


@pytest.mark.parametrize("preset", PRESETS)
def test_preset_is_meant_where_the_current_folder_has_a_run_of_its_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, preset: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / preset).mkdir()
    (tmp_path / preset / SAVED).write_text("source: {synth: {figure: human}}\n")
    with APPLICATION.active(), pytest.raises(InputError) as refused:
        Sequence(tmp_path / "out", Path("nowhere")).run(preset)
    assert "nowhere" in str(refused.value)
    assert "exclude each other" not in str(refused.value)
