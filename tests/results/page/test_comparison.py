"""The page of a comparison in a real browser: one camera, one frame, joints that are selected in both bodies."""

import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from results.comparison_graphs import without
from results.rigged_bodies import spider
from results.sample_report import playing

from kinetree.tasks.results.comparison import compared_run, comparison
from kinetree.tasks.results.formats.colours import KINDS
from kinetree.tasks.results.page.comparison import ONLY_HERE, comparison_document

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")

FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"]  # fmt: skip
EVIL = "a <script>alert(1)</script> walk"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    a, b = spider(), without(spider(), "foot", "spur", "knee")
    runs = compared_run(EVIL, "m", a, None, 1.0), compared_run("b", "m", b, None, 1.0)
    text = comparison_document(comparison(runs, (a, b), None, [], 0.05), (a, b), (playing(a), playing(b)))
    out = tmp_path_factory.mktemp("page") / "comparison.html"
    out.write_text(text, encoding="utf-8")
    return out


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as play:
        chromium = play.chromium.launch(executable_path=CHROMIUM, args=FLAGS)
        yield chromium
        chromium.close()


@pytest.fixture(scope="module", params=[(1440, 900, "light"), (390, 844, "dark")], ids=["desk", "phone"])
def tab(browser: Any, path: Path, request: pytest.FixtureRequest) -> Iterator[Any]:
    width, height, scheme = request.param
    context = browser.new_context(viewport={"width": width, "height": height}, color_scheme=scheme, reduced_motion="reduce")
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
    """The page at its first frame with nothing selected; no error and no request may come of what a test does."""
    tab.evaluate("() => { const [a] = kinetree.players; a.play(false); a.resetView(); a.show(0); }")
    tab.evaluate("() => kinetree.selection.select(null)")
    yield tab
    assert tab.complaints == []


def of_both(tab: Any, what: str) -> list[Any]:
    """The value of an expression for both players."""
    return list(tab.evaluate(f"kinetree.players.map((player) => {what})"))


def test_both_bodies_show_one_frame(opened: Any) -> None:
    opened.focus("#stage-b")
    opened.keyboard.press("ArrowRight")
    opened.keyboard.press("ArrowRight")
    assert of_both(opened, "player.at") == [2, 2]
    assert "frame 2" in opened.inner_text("#when")


def test_turning_either_body_turns_both(opened: Any) -> None:
    places = "player.camera.position.toArray().map((x) => x.toFixed(4)).join()"
    before = of_both(opened, places)
    opened.focus("#stage-a")
    opened.keyboard.press("Shift+ArrowRight")
    turned = of_both(opened, places)
    assert turned[0] == turned[1] != before[0]
    opened.evaluate("() => kinetree.players[1].turn(0.4, 0)")
    again = of_both(opened, places)
    assert again[0] == again[1] != turned[0]


def test_joint_chosen_in_a_table_is_marked_in_both_and_has_its_curve(opened: Any) -> None:
    opened.click("#pairs button:text-is('arm')")
    assert of_both(opened, "player.scene.joints[player.marked].name") == ["arm", "arm"]
    assert "arm in A, arm in B" in opened.inner_text("#chart-name")
    assert opened.locator("#chart polyline").count() == 1
    opened.keyboard.press("Escape")
    assert of_both(opened, "player.marked") == [None, None]


def test_joint_of_one_run_alone_is_marked_there_alone(opened: Any) -> None:
    opened.click("#only button:text-is('knee')")
    assert of_both(opened, "player.marked === null ? null : player.scene.joints[player.marked].name") == ["knee", None]
    assert opened.inner_text("#chart-name") == "knee: only in A"


def test_joint_of_one_run_alone_has_a_colour_of_its_own(opened: Any) -> None:
    colours = opened.evaluate(
        "() => ['arm', 'knee'].map((name) => { const p = kinetree.players[0], c = p.renderer.domElement;"
        " const j = p.scene.joints.findIndex((k) => k.name === name);"
        " const v = p.point('joints', p.scene.joints.length, j).project(p.camera);"
        " const flat = new OffscreenCanvas(c.width, c.height).getContext('2d'); flat.drawImage(c, 0, 0);"
        " const pixel = flat.getImageData((v.x + 1) / 2 * c.width, (1 - v.y) / 2 * c.height, 1, 1).data;"
        " return '#' + [0, 1, 2].map((k) => pixel[k].toString(16).padStart(2, '0')).join('').toUpperCase(); })"
    )
    assert colours == [KINDS["joint"], ONLY_HERE]


def test_joint_clicked_in_a_body_is_chosen(opened: Any) -> None:
    at = opened.evaluate(
        "() => { const p = kinetree.players[1], c = p.renderer.domElement;"
        " const j = p.scene.joints.findIndex((k) => k.name === 'tail');"
        " const v = p.point('joints', p.scene.joints.length, j).project(p.camera);"
        " return { x: (v.x + 1) / 2 * c.clientWidth, y: (1 - v.y) / 2 * c.clientHeight }; }"
    )
    opened.click("#stage-b", position=at)
    assert "tail in A, tail in B" in opened.inner_text("#chart-name")


def test_curve_goes_to_the_frame_that_is_clicked(opened: Any) -> None:
    box = opened.locator("#chart").bounding_box()
    opened.click("#chart", position={"x": box["width"] - 12, "y": box["height"] / 2})
    assert of_both(opened, "player.at") == [11, 11]


def test_nothing_is_wider_than_the_screen(opened: Any) -> None:
    assert opened.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


def test_names_from_outside_are_text(opened: Any) -> None:
    assert EVIL in opened.inner_text("h1")
