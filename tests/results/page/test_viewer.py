"""The page in a real browser: it plays, its toggles work, no error, no request, at two sizes."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from results.sample_report import page

from kinetree.pipeline import views
from kinetree.schemas.results.report import Report
from kinetree.tasks.results.page.document import Remark

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")

FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"]  # fmt: skip
RAN = {"run": "<b>r</b>", "status": "done", "nodes": {"ran": 3}, "seconds": 1.5, "failures": [], "versions": {"numpy": "2"},
       "tasks": {"mesh": {"ran": 3, "fresh": 0, "failed": 0, "seconds": 0.25}},
       "graph": {"mesh": {"over": "frame", "reads": ["source"]}},
       "config": {"a": "</script><script>alert(1)</script>"}}  # fmt: skip


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as play:
        chromium = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    report = Report(
        text=np.frombuffer(page("a <script>alert(1)</script> walk", faults=[Remark("arm", 7, 1)]).encode(), np.uint8)
    )
    out = tmp_path_factory.mktemp("page") / "report.html"
    out.write_bytes(views.page(report, RAN))
    return out


@pytest.fixture(scope="module", params=[(1200, 900), (390, 844)], ids=["desk", "phone"])
def tab(browser: Any, path: Path, request: pytest.FixtureRequest) -> Iterator[Any]:
    width, height = request.param
    context = browser.new_context(viewport={"width": width, "height": height}, reduced_motion="reduce")
    tab = context.new_page()
    tab.complaints = []
    tab.on("console", lambda m: tab.complaints.append(m.text) if m.type == "error" else None)
    tab.on("pageerror", lambda e: tab.complaints.append(str(e)))
    tab.on("dialog", lambda d: tab.complaints.append("a dialog opened"))
    tab.on("request", lambda r: tab.complaints.append(r.url[:60]) if not r.url.startswith(("file:", "data:")) else None)
    tab.goto(path.as_uri())
    tab.wait_for_selector("body[data-ready=yes]")
    yield tab
    context.close()


@pytest.fixture
def opened(tab: Any) -> Iterator[Any]:
    """The page as it was opened, at its first frame; no error and no request may come of what a test does."""
    tab.evaluate("() => { kinetree.play(false); kinetree.resetView(); kinetree.show(0); }")
    yield tab
    assert tab.complaints == []


def drawn(tab: Any) -> str:
    """What the canvas shows."""
    return str(tab.evaluate("document.getElementById('stage').toDataURL()"))


def test_player_waits_when_motion_is_unwelcome_and_plays_when_asked(opened: Any) -> None:
    assert opened.inner_text("#play") == "Play"
    assert opened.evaluate("kinetree.at") == 0
    opened.click("#play")
    advanced = "new Promise(done => { const look = () => kinetree.at > 0 ? done(true) : requestAnimationFrame(look); look(); })"
    assert opened.evaluate(advanced)
    opened.click("#play")
    assert opened.inner_text("#play") == "Play"


def test_scrubbing_shows_another_picture_and_names_the_frame(opened: Any) -> None:
    before = drawn(opened)
    opened.evaluate("() => { const s = document.getElementById('scrub'); s.value = 5; s.dispatchEvent(new Event('input')); }")
    assert opened.evaluate("kinetree.at") == 5
    assert "frame 5" in opened.inner_text("#when")
    assert drawn(opened) != before


@pytest.mark.parametrize("toggle", ["see-aligned", "see-input", "see-parts", "see-skeleton", "see-leaves"])
def test_every_toggle_changes_the_picture_and_changes_it_back(opened: Any, toggle: str) -> None:
    opened.set_checked("#see-aligned", toggle != "see-input")  # the aligned mesh lies where the input does
    before = drawn(opened)
    opened.locator(f"#{toggle}").click()
    assert drawn(opened) != before
    opened.locator(f"#{toggle}").click()
    assert drawn(opened) == before
    opened.check("#see-aligned")


def test_keyboard_alone_steps_turns_and_plays(opened: Any) -> None:
    opened.focus("#stage")
    opened.keyboard.press("ArrowRight")
    assert opened.evaluate("kinetree.at") == 1
    before = drawn(opened)
    opened.keyboard.press("Shift+ArrowLeft")
    assert drawn(opened) != before
    opened.keyboard.press("End")
    assert opened.evaluate("kinetree.at") == 11


def test_interval_is_jumped_to(opened: Any) -> None:
    opened.select_option("#interval", index=2)
    assert opened.evaluate("kinetree.at") == 6


def test_reason_of_the_verdict_leads_to_its_frame(opened: Any) -> None:
    opened.click(".verdict button.go")
    assert opened.evaluate("kinetree.scene.frames[kinetree.at]") == 7


def test_nothing_is_wider_than_the_screen(opened: Any) -> None:
    assert opened.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


def test_what_ran_is_told_as_text(opened: Any) -> None:
    text = opened.inner_text("#run")
    assert "<b>r</b> done: 3 ran in 1.5 s" in text
    assert "mesh" in text
