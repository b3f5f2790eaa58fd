"""Laws of the colours of parts."""

import numpy as np
from matplotlib.colors import to_hex
from results import sample_report
from results.plain_names import plain
from results.rigged_bodies import spider

from kinetree.tasks.results.formats.colours import linear, pale_part_colours, part_colours
from kinetree.tasks.results.plots.mesoscopic import BEYOND
from kinetree.tasks.results.plots.structure import part_colours as colours_of_faces
from kinetree.tasks.results.plots.style import GROUND
from kinetree.tasks.results.segmentation import segmentation


def test_parts_that_touch_differ_and_what_is_no_part_is_white():
    body = spider()
    colours = part_colours(body.label, body.faces)
    assert (colours[-1] == 255).all()
    assert (colours[body.label[body.label == -1]] == 255).all()
    for a, b, c in body.label[body.faces]:
        for one, other in ((a, b), (b, c), (c, a)):
            if one != other:
                assert colours[one].tolist() != colours[other].tolist()


def test_what_lies_beyond_a_cone_stands_out_from_a_light_and_from_a_dark_page():
    def luminance(colour):
        return float(linear(np.array([int(colour[k : k + 2], 16) for k in (1, 3, 5)], np.uint8)) @ [0.2126, 0.7152, 0.0722])

    own = luminance(to_hex(BEYOND)) + 0.05
    for page in ("#FFFFFF", GROUND):
        other = luminance(page) + 0.05
        assert max(own, other) / min(own, other) > 3.0


def test_linear_light_keeps_black_and_white_and_halves_at_the_known_byte():
    np.testing.assert_allclose(linear(np.array([0, 188, 255], np.uint8)), [0.0, 0.5029, 1.0], atol=1e-4)


def test_a_part_has_one_colour_in_files_on_the_page_in_pictures_and_in_the_segmentation():
    body = spider()
    own = part_colours(body.label, body.faces)
    hexes = [f"#{bytes(rgb.tolist()).hex().upper()}" for rgb in own[:-1]]
    player = sample_report.trusted().description["palette"]
    assert player == hexes
    np.testing.assert_allclose(pale_part_colours(body.label, body.faces), (own / 255 + 1) / 2)
    of_faces = colours_of_faces(body)[:, :3]
    inside = (body.label[body.faces] == body.label[body.faces][:, :1]).all(axis=1)
    np.testing.assert_allclose(of_faces[inside], (own[body.label[body.faces[inside, 0]]] / 255 + 1) / 2)
    content = sample_report.artifacts()
    stored = segmentation(body, plain(body), content["alignment"], content["projection"])
    np.testing.assert_array_equal(stored.colour[: len(own) - 1], own[:-1])
    assert len(stored.colour) == len(stored.names)
