"""Laws of opening one file that holds all frames: by its ending, once for the same bytes, refused with its name."""

import numpy as np
import pytest
from numerics.input.animated_glbs import TENTHS, GlbDraft

from kinetree.errors import SourceError
from kinetree.tasks.numerics.input.animated import SUFFIXES, read_animated


def test_same_file_is_read_once_and_a_changed_one_anew(tmp_path):
    path = tmp_path / "walk.GLB"
    path.write_bytes(GlbDraft().moves("translation", TENTHS, np.outer(TENTHS, [1, 0, 0])).raw())
    frames = read_animated(path)
    assert read_animated(path) is frames
    path.write_bytes(
        GlbDraft().moves("translation", TENTHS, np.outer(TENTHS, [1, 0, 0])).moves("scale", [0], [[1, 1, 1]]).raw()
    )
    assert read_animated(path) is not frames


def test_clips_are_of_glb_alone(tmp_path):
    (tmp_path / "walk.zip").write_bytes(b"")
    with pytest.raises(SourceError, match=r"source\.clip wave: only a GLB has clips; leave it out for walk\.zip"):
        read_animated(tmp_path / "walk.zip", "wave")


@pytest.mark.parametrize("suffix", SUFFIXES)
def test_what_is_none_is_refused_with_its_name(tmp_path, suffix):
    path = tmp_path / f"walk{suffix}"
    with pytest.raises(SourceError, match=r"walk\.\w+: cannot be read: No such file or directory"):
        read_animated(path)
    path.write_bytes(b"something else altogether")
    with pytest.raises(SourceError, match=f"walk{suffix}"):
        read_animated(path)
