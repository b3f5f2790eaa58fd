"""Laws of the colours of parts."""

import numpy as np
from results.rigged_bodies import spider

from kinetree.tasks.results.formats.colours import linear, part_colours


def test_parts_that_touch_differ_and_what_is_no_part_is_white():
    body = spider()
    colours = part_colours(body.label, body.faces)
    assert (colours[-1] == 255).all()
    assert (colours[body.label[body.label == -1]] == 255).all()
    for a, b, c in body.label[body.faces]:
        for one, other in ((a, b), (b, c), (c, a)):
            if one != other:
                assert colours[one].tolist() != colours[other].tolist()


def test_linear_light_keeps_black_and_white_and_halves_at_the_known_byte():
    np.testing.assert_allclose(linear(np.array([0, 188, 255], np.uint8)), [0.0, 0.5029, 1.0], atol=1e-4)
