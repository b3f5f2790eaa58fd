"""Laws of names in strict formats."""

from hypothesis import given
from hypothesis import strategies as st

from kinetree.tasks.results.formats.names import identifiers


@given(st.lists(st.text(), unique=True, max_size=12))
def test_any_names_become_words_of_ascii_that_are_still_unique(names):
    found = identifiers(names)
    assert len(found) == len(names) == len(set(found))
    assert all(word.isascii() and word.isidentifier() for word in found)


@given(st.lists(st.from_regex(r"[a-z_][a-z0-9_]{0,8}", fullmatch=True), unique=True, max_size=12))
def test_names_that_are_words_already_stay_as_they_are(names):
    assert identifiers(names) == names
