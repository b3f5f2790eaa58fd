"""The page in a real browser: it plays, its toggles work, no error, no request, at two sizes."""

import io
import re
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image
from results.plain_names import plain
from results.rigged_bodies import skinned, spider
from results.sample_report import page, trusted

from kinetree.pipeline import views
from kinetree.schemas.results.report import Report
from kinetree.tasks.results.page.document import Remark, Section, picture
from kinetree.tasks.results.plots.drawing import view
from kinetree.tasks.results.plots.structure import tree

sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="no Chromium on this machine")

FLAGS = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run",
         "--disable-background-networking", "--disable-component-update", "--disable-sync", "--disable-quic"]  # fmt: skip
RAN = {"run": "<b>r</b>", "status": "done", "nodes": {"ran": 3}, "seconds": 1.5, "failures": [], "versions": {"numpy": "2"},
       "tasks": {"mesh": {"ran": 3, "fresh": 0, "failed": 0, "seconds": 0.25}},
       "graph": {"mesh": {"over": "frame", "reads": ["source"]}},
       "files": ["report.html", "skeleton.glb", "skeleton.json"],
       "config": "source:\n  input: /takes/</script><script>alert(1)</script>walk\n"}  # fmt: skip


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


@pytest.fixture(scope="module", params=[(1440, 900), (390, 844)], ids=["desk", "phone"])
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


@pytest.mark.parametrize("toggle", ["see-skeleton", "see-leaves", "see-bounds"])
def test_every_toggle_changes_the_picture_and_changes_it_back(opened: Any, toggle: str) -> None:
    before = drawn(opened)
    opened.locator(f"#{toggle}").click()
    assert drawn(opened) != before
    opened.locator(f"#{toggle}").click()
    assert drawn(opened) == before


def test_bounds_are_not_shown_at_first_and_a_key_shows_them_as_large_as_they_are_in_this_frame(opened: Any) -> None:
    assert not opened.is_checked("#see-bounds")
    before = drawn(opened)
    opened.locator("#stage").focus()
    opened.keyboard.press("b")
    assert opened.is_checked("#see-bounds")
    assert drawn(opened) != before
    joints = [j for j, kind in enumerate(spider().kinds) if kind == "joint"]
    for frame, radius in ((0, 1.5), (1, 1.0)):
        opened.evaluate(f"kinetree.show({frame})")
        sizes = opened.evaluate("""kinetree.bounds.children.map((discs) => kinetree.scene.joints.map((_, j) => {
            const place = new THREE.Matrix4();
            discs.getMatrixAt(j, place);
            return place.getMaxScaleOnAxis();
        }))""")
        for size in np.array(sizes):
            assert size[joints] == pytest.approx(radius, rel=1e-6)
            assert np.delete(size, joints) == pytest.approx(0.0)
    opened.keyboard.press("B")
    assert not opened.is_checked("#see-bounds")


def test_the_bound_of_the_selected_joint_is_told_in_words(opened: Any) -> None:
    opened.evaluate("kinetree.select(1)")
    assert "Selected: left shoulder, joint, 90 % bound 1.5" in opened.get_attribute("#stage", "aria-label")
    assert "B shows the error bound of every joint" in opened.inner_text("#keys")
    opened.evaluate("kinetree.select(null)")


def test_a_page_without_bounds_has_no_switch_for_them(browser: Any, tmp_path: Path) -> None:
    (tmp_path / "report.html").write_bytes(page("a walk", scene=trusted(bounds=False)).encode())
    tab = browser.new_page()
    complaints: list[str] = []
    tab.on("pageerror", lambda e: complaints.append(str(e)))
    tab.goto((tmp_path / "report.html").as_uri())
    tab.wait_for_selector("body[data-ready=yes]")
    assert tab.query_selector("#see-bounds") is None
    assert "error bound of every joint" not in tab.inner_text("#keys")
    tab.locator("#stage").focus()
    tab.keyboard.press("b")
    assert complaints == []
    tab.close()


def test_every_mode_and_every_colour_is_another_picture(opened: Any) -> None:
    for name, usual, pictures in (
        ("mode", "rig", {"rig", "overlay", "sides"}),
        ("colour", "parts", {"parts", "error", "confidence", "plain"}),
    ):
        there = {option.get_attribute("value") for option in opened.query_selector_all(f"#{name} option")}
        assert there >= set(pictures)
        pictures_drawn = set()
        for value in pictures:
            opened.select_option(f"#{name}", value)
            pictures_drawn.add(drawn(opened))
        assert len(pictures_drawn) == len(pictures)
        opened.select_option("#mode", "rig")
        opened.select_option(f"#{name}", usual)
        opened.select_option("#colour", "parts")


def test_bodies_side_by_side_are_not_squeezed(opened: Any) -> None:
    opened.select_option("#mode", "sides")
    width, height = opened.evaluate("[kinetree.renderer.domElement.clientWidth, kinetree.renderer.domElement.clientHeight]")
    assert opened.evaluate("kinetree.camera.aspect") == pytest.approx(width / 2 / height)
    opened.select_option("#mode", "rig")
    assert opened.evaluate("kinetree.camera.aspect") == pytest.approx(width / height)


def test_rig_is_where_the_skinned_mesh_is(opened: Any) -> None:
    body, t = spider(), 5
    opened.evaluate("kinetree.show(5)")
    drawn_rig = np.array(opened.evaluate("Array.from(kinetree.rig.geometry.attributes.position.array)")).reshape(-1, 3)
    true = skinned(body)[t] @ view(list(skinned(body)))
    assert np.abs(np.sort(drawn_rig, axis=0)[[0, -1]] - np.sort(true, axis=0)[[0, -1]]).max() < 1e-3


def test_a_joint_is_selected_on_the_stage_and_in_the_table(opened: Any) -> None:
    row = opened.locator("tr[data-joint='1'] button")
    row.click()
    assert opened.evaluate("kinetree.selected") == 1
    assert opened.inner_text("#selected") == "left shoulder"
    opened.keyboard.press("Escape")
    assert row.get_attribute("aria-pressed") == "false"
    x, y = opened.evaluate("kinetree.place(1)")
    opened.locator("#stage").click(position={"x": x, "y": y})
    assert row.get_attribute("aria-pressed") == "true"
    opened.keyboard.press("Escape")


def test_controls_are_above_the_fold_and_a_swipe_scrolls(opened: Any) -> None:
    if opened.viewport_size["width"] > 1000:
        assert opened.evaluate("document.getElementById('home').getBoundingClientRect().bottom + scrollY") <= 900
    assert opened.evaluate("getComputedStyle(document.getElementById('stage')).touchAction") == "pan-y"


def test_title_names_the_data_and_files_that_the_run_left_are_offered(opened: Any) -> None:
    assert opened.title().startswith("script>walk: a <script>")
    assert [link.get_attribute("href") for link in opened.query_selector_all("#files a")] == ["skeleton.glb", "skeleton.json"]


def test_a_script_that_was_changed_is_refused(browser: Any, path: Path, tmp_path: Path) -> None:
    changed = tmp_path / "changed.html"
    changed.write_text(path.read_text().replace("begin();\n", "begin();;\n"))
    tab = browser.new_page()
    refused: list[str] = []
    tab.on("console", lambda m: refused.append(m.text))
    tab.goto(changed.as_uri())
    assert any("Content Security Policy" in text for text in refused)
    assert tab.evaluate("typeof ReportPlayer") == "undefined"
    tab.close()


def test_keyboard_alone_steps_turns_and_plays(opened: Any) -> None:
    opened.focus("#stage")
    opened.keyboard.press("ArrowRight")
    assert opened.evaluate("kinetree.at") == 1
    before = drawn(opened)
    opened.keyboard.press("Shift+ArrowLeft")
    assert drawn(opened) != before
    opened.keyboard.press("End")
    assert opened.evaluate("kinetree.at") == 11


def test_stage_says_in_words_what_it_shows(opened: Any) -> None:
    def words() -> str:
        return str(opened.get_attribute("#stage", "aria-label"))

    description = "the rig as exported, a colour for every part, and its skeleton of 2 joints under "
    assert re.match(rf"The body at frame 0\b.*, one of 12 frames: {description}", words())
    opened.evaluate("kinetree.select(1)")
    opened.select_option("#colour", "error")
    assert "coloured by the distance to the input" in words()
    assert re.search(r"Selected: left shoulder, joint, 90 % bound 1\.5\b[^.]*\.$", words())
    opened.select_option("#colour", "parts")
    opened.evaluate("kinetree.select(null)")


def test_interval_is_jumped_to(opened: Any) -> None:
    opened.select_option("#interval", index=2)
    assert opened.evaluate("kinetree.at") == 6


def test_reason_of_the_verdict_leads_to_its_frame(opened: Any) -> None:
    opened.click(".verdict button.go")
    assert opened.evaluate("kinetree.scene.frames[kinetree.at]") == 7


def test_nothing_is_wider_than_the_screen(opened: Any) -> None:
    assert opened.evaluate("document.documentElement.scrollWidth <= window.innerWidth")


def test_what_ran_is_told_as_text(opened: Any) -> None:
    opened.evaluate("() => document.querySelectorAll('details').forEach((d) => { d.open = true; })")
    text = opened.inner_text("#run")
    assert "<b>r</b> done: 3 ran in 1.5 s" in text
    assert "mesh" in text


def test_pictures_turn_dark_with_the_page(browser: Any, tmp_path: Path) -> None:
    """What a picture's ground is on the screen, at its corner."""
    body = spider()
    figure = tree(lambda name: plain(body) if name == "joint_names" else body, [])
    path = tmp_path / "pictured.html"
    path.write_text(page(sections=[Section("tree", "Tree", picture(figure, "a tree", "a tree of joints"))]))
    grounds = []
    for scheme in ("light", "dark"):
        context = browser.new_context(color_scheme=scheme, reduced_motion="reduce")
        tab = context.new_page()
        tab.goto(path.as_uri())
        tab.locator("figure img").first.scroll_into_view_if_needed()
        shot = Image.open(io.BytesIO(tab.locator("figure img").first.screenshot())).convert("L")
        grounds.append(shot.getpixel((3, 3)))
        context.close()
    assert grounds[0] > 240
    assert grounds[1] < 60


def test_assumed_joints_are_hollow_on_dashed_bones_and_said(browser: Any, tmp_path: Path) -> None:
    pictures_drawn, words = [], []
    for assumed in ((), (("left elbow", 2, (8.6, 1.4, 0.0)),)):
        path = tmp_path / "report.html"
        report = Report(text=np.frombuffer(page(scene=trusted(assumed)).encode(), np.uint8))
        path.write_bytes(views.page(report, RAN))
        tab = browser.new_page(viewport={"width": 1440, "height": 900}, reduced_motion="reduce")
        complaints: list[str] = []
        tab.on("pageerror", lambda e, all_of_it=complaints: all_of_it.append(str(e)))
        tab.goto(path.as_uri())
        tab.wait_for_selector("body[data-ready=yes]")
        pictures_drawn.append(drawn(tab))
        words.append(tab.get_attribute("#stage", "aria-label"))
        if assumed:
            at = tab.evaluate("kinetree.placeOf(kinetree.assumedPoint(0))")
            inner, outer = (tab.evaluate(f"kinetree.place({j})") for j in (1, 2))
            assert min(inner[0], outer[0]) - 1 <= at[0] <= max(inner[0], outer[0]) + 1
            assert tab.evaluate("kinetree.hollows.concat(kinetree.dashes).map(part => part.count)") == [1, 1, 9, 9]
            tab.click("#see-names")
            assert "left elbow (assumed)" in tab.inner_text("#names")
        tab.close()
        assert complaints == []
    assert pictures_drawn[0] != pictures_drawn[1]
    assert "Assumed" not in words[0]
    assert "Assumed, not found: left elbow." in words[1]


def test_colours_of_the_input_are_shown_on_rig_and_input_where_there_are_any(browser: Any, tmp_path: Path) -> None:
    blue = np.tile(np.array([20, 40, 230], np.uint8), (len(spider().vertices), 1))
    offered = []
    for colours in (None, blue):
        path = tmp_path / "report.html"
        path.write_bytes(views.page(Report(text=np.frombuffer(page(scene=trusted(colours=colours)).encode(), np.uint8)), RAN))
        tab = browser.new_page(viewport={"width": 1440, "height": 900}, reduced_motion="reduce")
        tab.goto(path.as_uri())
        tab.wait_for_selector("body[data-ready=yes]")
        offered.append(tab.locator("#colour option[value=input]").count())
        if colours is not None:
            tab.select_option("#colour", "input")
            tab.click("#see-skeleton")
            for mode in ("rig", "aligned", "input"):
                tab.select_option("#mode", mode)
                shot = np.asarray(Image.open(io.BytesIO(tab.locator("#stage").screenshot())).convert("RGB"), int)
                strong = shot[np.ptp(shot, axis=2) > 80]  # the body, not the stage
                assert len(strong) > 1000
                assert (strong[:, 2] > strong[:, 0] + 60).mean() > 0.98
            assert "in the colours of the input" in tab.get_attribute("#stage", "aria-label")
        tab.close()
    assert offered == [0, 1]
