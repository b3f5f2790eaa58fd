"""Laws of the two styles: dark pages turn pictures dark, papers get columns, one size of text, and greys that differ."""

import re
from itertools import combinations
from pathlib import Path
from typing import Any, get_args

import pytest
from matplotlib.text import Text
from results.rigged_bodies import spider
from results.sample_derivation import parts_of, reference_of, tree_of
from results.sample_report import artifacts, judged

from kinetree.errors import ConfigError
from kinetree.tasks.commands import plot
from kinetree.tasks.results.formats.colours import LINES
from kinetree.tasks.results.page.document import rendered
from kinetree.tasks.results.plots import PLOTS, draw
from kinetree.tasks.results.plots.drawing import blank
from kinetree.tasks.results.plots.style import COLUMN, HEADING, LIGHTNESS, PAGE, POINTS, Style, for_paper, lightness


@pytest.fixture(scope="module")
def fetch() -> Any:
    body = spider()
    derived = {"reference": reference_of(body), "rigid_parts": parts_of(body), "kinematic_tree": tree_of(body)}
    stored = artifacts() | {"evaluation": judged(body)} | derived
    return lambda name, frame=None: stored[name] if frame is None else stored[name][frame]


@pytest.mark.parametrize("what", sorted(PLOTS))
def test_paper_is_as_wide_as_a_column_or_a_page_in_one_size_of_text_without_headings(fetch: Any, what: str) -> None:
    figure = for_paper(PLOTS[what](fetch, [0, 6], 1))
    assert figure.get_size_inches()[0] in (COLUMN, PAGE)
    texts = [text for text in figure.findobj(Text) if text.get_text()]
    assert {text.get_fontsize() for text in texts} == {POINTS}
    assert not [text for text in texts if text.get_gid() == HEADING]


def test_bodies_beside_one_another_are_equally_large(fetch: Any) -> None:
    for what in ("skeleton", "mu"):
        panels = PLOTS[what](fetch, [0, 3, 6], 1).axes
        for limits in ([axes.get_xlim() for axes in panels], [axes.get_ylim() for axes in panels]):
            assert len({round(high - low, 9) for low, high in limits}) == 1


def test_colours_of_curves_differ_in_a_grey_print() -> None:
    figure, axes = blank(3.0, 2.0)
    for colour in LINES:
        axes.plot([0, 1], [0, 1], color=colour)
    printed = [str(line.get_color()) for line in axes.lines]
    assert min(abs(lightness(a) - lightness(b)) for a, b in combinations(LINES, 2)) < 4  # as they are on screens
    from matplotlib.colors import to_hex

    for_paper(figure)
    printed = [lightness(to_hex(line.get_color())) for line in axes.lines]
    assert min(abs(a - b) for a, b in combinations(printed, 2)) >= 7.5
    assert printed == pytest.approx(list(LIGHTNESS.values()), abs=0.5)


def test_white_and_black_have_the_lightness_that_the_cie_gives_them() -> None:
    assert lightness("#000000") == 0.0
    assert lightness("#FFFFFF") == pytest.approx(100.0)
    assert lightness("#777777") == pytest.approx(50.0, abs=0.5)


def test_pictures_on_a_page_are_drawn_light_on_dark_where_the_viewer_prefers_it(fetch: Any) -> None:
    svg = rendered(PLOTS["tree"](fetch, [], 1)).decode()
    assert "prefers-color-scheme: dark" in svg[: svg.index("<g")]
    used = set(re.findall(r"(?:stroke|fill): #(?:000000|ffffff)", svg[svg.index("</style>") :]))
    assert {"stroke: #000000", "fill: #ffffff"} & used <= set(re.findall(r'\*="(.*?)"', svg))


def test_paper_has_no_dark_side_and_an_unknown_style_is_refused(fetch: Any, tmp_path: Path) -> None:
    for style in get_args(Style):
        draw("tree", fetch, [], tmp_path / f"{style}.svg", style=style)
    assert "prefers-color-scheme" not in (tmp_path / "paper.svg").read_text()
    assert "prefers-color-scheme" in (tmp_path / "screen.svg").read_text()
    with pytest.raises(ConfigError, match="--style print: write screen or paper"):
        plot.plot("nowhere", "tree", style="print")


def test_the_command_knows_every_style() -> None:
    assert get_args(Style) == plot.STYLES
