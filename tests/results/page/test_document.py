"""The page: one file, text from outside escaped, no request to the network."""

import base64
import hashlib
import io
import json
import re
import threading

import numpy as np
import pytest
from matplotlib import rcParams
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from results.sample_report import page, trusted

from kinetree.pipeline import views
from kinetree.schemas.results.report import RUN, Report
from kinetree.tasks.results.formats.colours import KINDS, NOT_RIGID, PARTS, linear
from kinetree.tasks.results.page.document import Remark, as_script, page_file, rendered, table
from kinetree.tasks.results.plots.drawing import blank, verbatim
from kinetree.tasks.results.plots.style import PAGE_DOTS, following_the_page, rendering

EVIL = "</script><script>alert(1)</script>{{scene}}<!--"


def test_words_from_outside_are_escaped_everywhere():
    text = page(EVIL, headline=EVIL, facts=[(EVIL, EVIL)], faults=[Remark(EVIL, 3)], notes=[Remark(EVIL)])
    assert text.count("<script") == 5
    assert "alert(1)" in text
    assert "<script>alert" not in text
    assert text.count("{{scene}}") >= 4


def test_json_in_a_script_cannot_end_it_and_reads_as_it_was():
    value = {EVIL: [EVIL, 1.5, None]}
    assert "<" not in as_script(value)
    assert json.loads(as_script(value)) == value


def test_numbers_that_json_does_not_know_are_refused():
    with pytest.raises(ValueError, match="JSON compliant"):
        as_script({"a": float("nan")})


def test_page_asks_nothing_of_the_network():
    text = page()
    assert "default-src 'none'" in text
    assert not re.findall(r'(?:src|href)="(?!data:|#)[^"]*"', text)


def test_what_ran_is_laid_into_the_page_harmlessly():
    text = page()
    assert text.count(RUN) == 1
    report = Report(text=np.frombuffer(text.encode(), np.uint8))
    html = views.page(report, {"run": EVIL}).decode()
    assert RUN not in html
    record = re.search(r'<script type="application/json" id="run-record">(.*?)</script>', html)
    assert record is not None
    assert json.loads(record.group(1)) == {"run": EVIL}


def test_verdict_stands_before_the_player_and_its_reasons_lead_to_frame_and_joint():
    text = page(level="except", headline="good except for arm in frame 3", faults=[Remark("arm: wrong", 3, 1), Remark("short")])
    assert text.index('class="verdict except"') < text.index('id="stage"')
    assert "good except for arm in frame 3</h2>" in text
    assert '<li><button type="button" class="go" data-frame="3" data-joint="1">arm: wrong</button></li><li>short</li>' in text


def test_many_reasons_are_folded_so_that_the_player_stays_on_the_screen():
    text = page(level="except", faults=[Remark(f"reason {n}") for n in range(6)])
    assert "<li>reason 3</li></ul><details><summary>2 more</summary><ul><li>reason 4</li>" in text
    assert "<summary>1 more" not in page(level="except", faults=[Remark("one")])


def test_notes_are_folded_and_stand_only_where_there_are_some():
    assert 'class="notes"' not in page()
    text = page(notes=[Remark("leaf 2 is lost")])
    assert '<details class="notes"><summary>1 note that does not change this</summary><ul><li>leaf 2 is lost</li>' in text
    assert text.index('id="stage"') < text.index('class="notes"')


def test_every_joint_kind_has_its_colour_in_the_legend():
    text = page()
    for name, colour in {**KINDS, "surface that is not rigid": NOT_RIGID}.items():
        assert f'style="background:{colour}"></span> {name}</span>' in text


def test_legend_has_assumed_joints_where_there_are_some():
    assert "assumed, not found" not in page()
    assert "assumed, not found, on a dashed bone</span>" in page(scene=trusted(assumed=(("left elbow", 2, (8.6, 1.4, 0.0)),)))


def test_tables_put_numbers_to_the_right_and_escape_cells():
    html = table(("a", "b"), [("<b>", 1.23456), ("c", 2)])
    assert "&lt;b&gt;" in html
    assert '<td class="n">1.235</td>' in html


def test_tables_show_what_rounding_left_of_zero_as_zero():
    html = table(("a", "b", "c"), [(2.958e-06, -1.4e-13, 0.00012)])
    assert re.findall(r"<td[^>]*>([^<]*)</td>", html) == ["0", "0", "0.00012"]


def test_policy_allows_exactly_the_scripts_of_the_page():
    text = page()
    policy = re.search(r"script-src ([^;]*);", text).group(1)
    scripts = re.findall(r"<script>(.*?)</script>", text, re.DOTALL)
    digests = [base64.b64encode(hashlib.sha256(script.encode()).digest()).decode() for script in scripts]
    assert policy == " ".join(f"'sha256-{digest}'" for digest in digests)
    assert len(scripts) == 2


def test_marks_of_joints_stand_out_from_every_part_and_from_the_stage():
    rings = [(255, 255, 255), (0, 0, 0)]
    stage = [tuple(bytes.fromhex(c[1:])) for c in re.findall(r"--stage-\w+: (#\w{6})", page_file("style.css"))]
    assert len(stage) == 4
    for colour in [*(tuple(bytes.fromhex(c[1:])) for c in (*PARTS, NOT_RIGID)), *stage]:
        for light in (1.0, 0.5):  # lit and in the shade
            shade = tuple(int(light * c) for c in colour)
            assert max(contrast(shade, ring) for ring in rings) >= 3


def contrast(a, b):
    """Contrast ratio of two sRGB colours (WCAG 2.2)."""
    high, low = sorted((float(linear(np.array(c, np.uint8)) @ [0.2126, 0.7152, 0.0722]) for c in (a, b)), reverse=True)
    return (high + 0.05) / (low + 0.05)


def test_figures_that_are_written_at_once_do_not_share_settings():
    """Settings of matplotlib are those of the process: the first to be done would take them from the other."""
    begun, first_is_done, fonts = threading.Event(), threading.Event(), []

    class First(Figure):
        def draw(self, renderer):
            other.start()
            begun.wait(0.5)  # in vain where they wait for each other

    class Second(Figure):
        def draw(self, renderer):
            begun.set()
            first_is_done.wait()
            fonts.append(rcParams["svg.fonttype"])

    other = threading.Thread(target=rendered, args=(Second(),))
    rendered(First())
    first_is_done.set()
    other.join()
    assert fonts == ["none"]


def test_figure_is_drawn_once_and_has_the_bytes_that_savefig_gives_it(monkeypatch):
    def drawn():
        figure, (off, on) = blank(4.0, 2.0, 2)
        off.set_axis_off()
        on.set_title("$ 1")
        figure.colorbar(on.scatter([0, 1], [1, 0], c=[0, 1]), ax=on)
        return figure

    twice = io.BytesIO()
    with rendering():
        told = {"format": "svg", "dpi": PAGE_DOTS, "metadata": {"Date": None, "Creator": None}}
        verbatim(drawn()).savefig(twice, **told)
    draws, plain = [], Axes.draw
    monkeypatch.setattr(Axes, "draw", lambda axes, *values: (draws.append(axes), plain(axes, *values)))
    figure = drawn()
    assert rendered(figure) == following_the_page(twice.getvalue())
    assert sorted(map(id, draws)) == sorted(map(id, figure.axes))


def test_axes_that_are_off_are_given_no_ticks(monkeypatch):
    figure, axes = blank(2.0, 2.0)
    axes.set_axis_off()
    axes.text(0.0, 0.0, "$ 1")
    monkeypatch.setattr(Axis, "get_major_ticks", lambda *_: pytest.fail("ticks are made for nobody"))
    verbatim(figure)
    assert not axes.texts[0].get_parse_math()
