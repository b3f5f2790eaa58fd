"""Laws of names in strict formats."""

from hypothesis import given
from hypothesis import strategies as st
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.tasks.results.formats.names import identifiers, readable_names


@given(st.lists(st.text(), unique=True, max_size=12))
def test_any_names_become_words_of_ascii_that_are_still_unique(names):
    unique = identifiers(names)
    assert len(unique) == len(names) == len(set(unique))
    assert all(word.isascii() and word.isidentifier() for word in unique)


@given(st.lists(st.from_regex(r"[a-z_][a-z0-9_]{0,8}", fullmatch=True), unique=True, max_size=12))
def test_names_that_are_words_already_stay_as_they_are(names):
    assert identifiers(names) == names


def test_people_read_sides_and_stations_in_words_and_other_names_as_they_are():
    anatomy = ("pelvis", "hind_knee_l", "hand_end_r", "spine_2", "", "", "")
    assert readable_names(plain(spider(), anatomy=anatomy)) == (
        "pelvis", "left hind knee", "right hand end", "spine 2", *spider().names[4:],
    )  # fmt: skip
