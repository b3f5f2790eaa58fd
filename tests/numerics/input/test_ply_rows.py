"""Laws of what a PLY header claims: exactly the rows that it says, none shifted, none left out."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kinetree.errors import MeshError
from kinetree.tasks.numerics.input.ply_rows import Element, elements, refuse_wrong_rows

HEADER = b"""ply
format ascii 1.0
comment element of surprise 3
element vertex 2
property float x
property float y
element face 1
property list uchar int vertex_indices
property uchar red
"""
VERTEX, FACE = Element("vertex", 2, (False, False)), Element("face", 1, (True, False))


def test_elements_come_in_the_order_of_the_header_with_their_lists():
    assert elements(HEADER) == [VERTEX, FACE]


def test_property_before_any_element_and_counts_that_are_none_are_passed_over():
    assert elements(b"property float x\nelement vertex many\nelement\nelement face 3\n") == [Element("face", 3, ())]


def test_header_of_more_properties_than_a_mesh_has_is_refused():
    header = b"element vertex 1\n" + b"property float x\n" * 500 + b"element face 1\n" + b"property list uchar int i\n" * 500
    assert [len(element.lists) for element in elements(header)] == [500, 500]
    with pytest.raises(MeshError, match=r"^its header has more than 1000 properties; the file is damaged or no mesh$"):
        elements(header + b"property float x\n")


def test_rows_that_agree_pass_with_blank_lines_between_them():
    refuse_wrong_rows([VERTEX, FACE], b"\n0 0\n\n1 1\n3 0 1 0 255\n \n")


@given(st.integers(0, 5), st.integers(0, 5), st.integers(0, 7))
def test_any_other_number_of_rows_is_refused(vertices, faces, missing):
    claimed = [Element("vertex", vertices, (False,)), Element("face", faces, (True,))]
    rows = [b"1.5"] * vertices + [b"3 0 0 0"] * faces
    refuse_wrong_rows(claimed, b"\n".join(rows))
    with pytest.raises(MeshError, match="1 more line after"):
        refuse_wrong_rows(claimed, b"\n".join([*rows, b"3 0 0 0"]))
    if missing < len(rows):
        with pytest.raises(MeshError, match="the file is cut short"):
            refuse_wrong_rows(claimed, b"\n".join(rows[:missing]))


@pytest.mark.parametrize(
    "row", ["3 0 1", "3 0 1 0", "3 0 1 0 255 255", "2 0 1 255", "3 0 1 0.5 255", "3 0 1 nine 255", "-3 255"]
)
def test_row_of_another_length_or_kind_is_named(row):
    with pytest.raises(MeshError, match=f"face 0 is '{row}', which is not what its header says"):
        refuse_wrong_rows([VERTEX, FACE], f"0 0\n1 1\n{row}\n".encode())
