"""Laws of halved parts on a tube whose hinges are known."""

import numpy as np
import pytest
from limbs import bent, tube
from shipped import PARTS

from kinetree.tasks.numerics.geometry.neighbours import rings
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.geometry.surface import Surface
from kinetree.tasks.numerics.structure.elimination import NormalisedBody
from kinetree.tasks.numerics.structure.halved_parts import halved
from kinetree.tasks.numerics.structure.oversegmentation import patches
from kinetree.tasks.numerics.structure.part_motion import fit
from kinetree.tasks.numerics.structure.score_spans import score_spans

FRAMES, HINGES = 8, (-1.7, 1.6)


def halves(label, hinges=HINGES, turn=0.6, takes=None):
    """V, label, and origin of a tube that bends at hinges, out of phase, cut as `label` of the height says and halved."""
    V, F = tube(20, 56)
    x = np.empty((FRAMES, *V.shape))
    for f in range(FRAMES):
        x[f] = V
        for k, z in reversed(list(enumerate(hinges))):
            x[f] = bent(x[f] - [0, 0, z], turn * np.sin(0.9 * f + 1.3 * k), 0.1) + [0, 0, z]
    surface = Surface.of(V, F)
    size = np.sqrt(surface.area.sum())
    body = NormalisedBody(
        (V - surface.centre) / size, vertex_normals(V, F), F, (x - x.mean(axis=1, keepdims=True)) / size,
        np.ones(x.shape[:2]), surface.area / size**2, *rings(F, len(V)), score_spans(FRAMES, takes),
    )  # fmt: skip
    part, limits = label(V[:, 2]).astype(np.int64), PARTS.elimination
    count = int(part.max()) + 1
    R, t = np.empty((FRAMES, count, 3, 3)), np.empty((FRAMES, count, 3))
    fit(body.V, body.x, body.weight, body.area, part, np.ones(count, np.bool_), False, len(V), limits.floor, R, t)
    patch = patches(surface, body.V, body.start, body.ring, 60)
    label, R, t, origin = halved(body, patch, part, R, t, limits, 2)
    assert R.shape[1] == t.shape[1] == len(origin) == label.max() + 1
    return V, label, origin


@pytest.mark.parametrize("takes", [None, [slice(0, 4), slice(4, 8)]])
def test_a_part_of_two_links_is_two_parts(takes):
    V, label, origin = halves(lambda z: z > HINGES[1], takes=takes)
    np.testing.assert_array_equal(origin, [0, 1, 0])
    links = np.searchsorted(np.array(HINGES), V[:, 2])
    assert sorted(np.bincount(links[label == k]).argmax() for k in range(3)) == [0, 1, 2]
    assert np.mean([(links[label == k] == np.bincount(links[label == k]).argmax()).mean() for k in range(3)]) > 0.9


def test_links_stay_whole():
    _, _, origin = halves(lambda z: np.searchsorted(np.array(HINGES), z))
    np.testing.assert_array_equal(origin, [0, 1, 2])


def test_what_turns_too_little_stays_whole():
    _, _, origin = halves(lambda z: np.zeros_like(z), hinges=HINGES[:1], turn=0.03)
    np.testing.assert_array_equal(origin, [0])


def test_flesh_beside_a_joint_is_no_half():
    """The tube's radius is 1: the border lies so near its one hinge that a joint between the halves would stand beside it."""
    _, _, origin = halves(lambda z: z > 0.9, hinges=(0.0,), turn=0.9)
    np.testing.assert_array_equal(origin, [0, 1])
