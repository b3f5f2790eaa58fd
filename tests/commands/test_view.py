"""`kinetree view`: opens the report, or says where it is."""

import webbrowser
from pathlib import Path

import pytest

from kinetree.errors import ConfigError
from kinetree.tasks.commands.view import view


@pytest.fixture
def run(tmp_path: Path) -> Path:
    config = tmp_path / "walk.yaml"
    config.write_text(f"output: {tmp_path / 'out'}\nsource:\n  synth: {{figure: human, frames: 2}}\n")
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / "report.html").write_text("<html>")
    return config


def opening(monkeypatch: pytest.MonkeyPatch, works: bool) -> list[str]:
    opened: list[str] = []
    monkeypatch.setenv("DISPLAY", ":0")
    monkeypatch.setattr(webbrowser, "open", lambda url: opened.append(url) or works)
    return opened


def test_report_is_opened_where_there_is_a_browser(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    opened = opening(monkeypatch, True)
    view(str(run))
    assert opened == [(run.parent / "out" / "report.html").as_uri()]
    assert capsys.readouterr().out == ""


@pytest.mark.parametrize("without", ["screen", "browser", "wish"])
def test_path_is_printed_where_nothing_can_be_opened(
    run: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], without: str
) -> None:
    opened = opening(monkeypatch, False)
    if without == "screen":
        monkeypatch.delenv("DISPLAY")
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    view(str(run), only_print=without == "wish")
    assert capsys.readouterr().out.strip() == str(run.parent / "out" / "report.html")
    assert len(opened) == (without == "browser")


def test_run_without_a_report_is_told_what_to_do(run: Path) -> None:
    (run.parent / "out" / "report.html").unlink()
    with pytest.raises(ConfigError, match="kinetree run"):
        view(str(run))
