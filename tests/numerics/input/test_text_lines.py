"""Lines are those of the whole text, wherever its pieces end, and no list of all is made."""

import tracemalloc

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input import text_lines as module
from kinetree.tasks.numerics.input.text_lines import text_lines


@given(st.lists(st.sampled_from([b"\n", b"\r", b"\\", b"a", b" "]), max_size=12).map(b"".join), st.integers(0, 4))
@example(b"ab\\\r\nc\n", 3)
@example(b"abcd\r\n\n", 4)
def test_lines_are_those_of_the_whole_text_wherever_its_pieces_end(raw, size):
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(module, "_PIECE_BYTES", size)
        assert list(text_lines(raw)) == raw.splitlines()
        joined = raw.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ").splitlines()
        assert list(text_lines(raw, are_continued=True)) == joined


@pytest.mark.parametrize("end", [b"\n", b"\r", b"\r\n"])
def test_lines_take_the_memory_of_a_piece(end):
    raw = (b"v 0 0 0" + end) * 10**6
    tracemalloc.start()
    assert sum(1 for _ in text_lines(raw)) == 10**6
    assert tracemalloc.get_traced_memory()[1] < 2 * len(raw)
    tracemalloc.stop()


def test_line_longer_than_any_row_is_refused(monkeypatch):
    monkeypatch.setattr(module, "_PIECE_BYTES", 4)
    monkeypatch.setattr(module, "_LONGEST_BYTES", 10)
    assert list(text_lines(b"f 1 2 3\nf 1 2 3 4\n")) == [b"f 1 2 3", b"f 1 2 3 4"]
    with pytest.raises(MeshError, match=r"^a line of more than 10 bytes; the file is damaged or no mesh$"):
        list(text_lines(b"f 1 2 3 \\\n4 5 6 7 8 9", are_continued=True))
