"""The table over sequences, and what is left of it: CSV, JSON and a page."""

import csv
import io
import json
import re

from results.sequence_tables import table

from kinetree.pipeline import views


def test_every_sequence_has_a_row_and_those_with_a_result_have_figures():
    result = table()
    assert [row.outcome.name for row in result.rows] == ["=dance", "torn", "walk & <b>"]
    assert [row.picture for row in result.rows] == [0, None, 1]
    assert [row.joints for row in result.rows] == [2, None, 2]
    assert [row.found for row in result.rows] == [None, None, 4]
    assert len(result.pictures) == 2


def test_csv_and_json_have_the_same_figures():
    files = views.files(table(), ())
    rows = list(csv.DictReader(io.StringIO(files["summary.csv"].decode())))
    full = json.loads(files["summary.json"])["sequences"]
    assert [row["percent"] for row in rows] == ["", "", "1.5"]
    assert [row["percent"] for row in full] == [None, None, 1.5]
    assert full[1]["failures"] == ["mesh[frame=3]: MeshError: <torn>", "another"]
    assert rows[1]["failures"] == "2"
    assert list(views.rows(table())[0]) == list(rows[0])


def test_no_name_is_a_formula_to_a_spreadsheet():
    rows = list(csv.DictReader(io.StringIO(views.files(table(), ())["summary.csv"].decode())))
    assert rows[0]["name"] == "'=dance"


def test_the_page_links_reports_escapes_names_and_needs_no_network():
    page = views.files(table(), ())["index.html"].decode()
    assert '<a href="walk%20%26%20%3Cb%3E/report.html">walk &amp; &lt;b&gt;</a>' in page
    assert "<b>torn</b>: mesh[frame=3]: MeshError: &lt;torn&gt; and 1 more" in page
    assert "<remark>" not in page
    assert page.count('src="data:image/png;base64,') == 2
    assert not re.search(r'(src|href)="https?:', page)
    assert "{{" not in page


def test_the_page_and_the_table_have_the_verdict_of_every_sequence():
    files = views.files(table(), ())
    page = files["index.html"].decode()
    assert page.count('class="judged except"') == 2
    assert "good except for left &lt;shoulder&gt;</span>" in page
    assert "<li>good except <b>2</b></li>" in page
    rows = list(csv.DictReader(io.StringIO(files["summary.csv"].decode())))
    assert [row["verdict"] for row in rows] == ["except", "", "except"]
    assert rows[0]["verdict_words"] == "good except for left <shoulder>"


def test_a_table_of_nothing_is_left_as_one():
    empty = views.files(table().model_copy(update={"rows": ()}), ())
    assert empty["summary.csv"].decode().strip() == "name"
