"""Laws of advice: every known foreign ending has a sentence, no ending that is read has one."""

from kinetree.tasks.numerics.input.animated import SUFFIXES
from kinetree.tasks.numerics.input.foreign import advice
from kinetree.tasks.numerics.input.formats import suffixes


def test_endings_that_are_read_have_no_advice():
    assert advice({*suffixes(), *SUFFIXES, ".npz", ".npy", ".nrrd", ".tif", ".png", ""}) == ""


def test_every_ending_gets_its_sentence_once():
    assert advice({".FBX", ".txt"}) == (
        "; .FBX is not read; kinetree convert makes a sequence of it where Blender is installed"
    )
    assert advice({".c3d", ".abc"}).index("; .abc is not read") < advice({".c3d", ".abc"}).index(
        "; .c3d holds a skeleton or markers"
    )
