"""One frame held against the truth: its vertices are counted by pairs of parts, and the true joints lie in the body."""

import numpy as np
import pytest
from results.true_skeletons import generated, held_against, observed, perfect

from kinetree.tasks.numerics.results.evaluation.parts import leading_parts
from kinetree.tasks.results.frame_truth import frame_truth
from kinetree.tasks.results.truth import synthetic, true_carriers

RECIPE = generated(frames=3, vertices=300)
PERFECT, TRUTH, OBSERVED = perfect(RECIPE), synthetic(RECIPE), observed(RECIPE)


def test_every_vertex_is_counted_once_with_its_part_and_its_true_joint() -> None:
    source, mesh, projection = OBSERVED
    _, by_frame = held_against(PERFECT, TRUTH, *OBSERVED)
    part = leading_parts(PERFECT.label, PERFECT.influence, PERFECT.weight)
    for t, truth in by_frame.items():
        assert (truth.frame, truth.known, truth.inside) == (t, True, True)
        carriers = true_carriers(TRUTH, source[t], mesh[t].vertices, t, PERFECT.unit)
        assert carriers is not None
        corner = PERFECT.faces[projection[t].face, projection[t].share.argmax(axis=1)]
        pairs = list(zip(part[corner].tolist(), *(c.tolist() for c in carriers), strict=True))
        rows = zip(*(getattr(truth, name).tolist() for name in ("part", "carrier", "bone_end", "count")), strict=True)
        assert {tuple(row): n for *row, n in rows} == {pair: pairs.count(pair) for pair in set(pairs)}


def test_a_frame_without_a_mesh_has_radii_and_no_parts() -> None:
    source, _, _ = OBSERVED
    _, by_frame = held_against(PERFECT, TRUTH, source, {}, {})
    for t, truth in by_frame.items():
        assert not truth.known
        assert len(truth.count) == 0
        away = np.linalg.norm(PERFECT.positions[t][:, None] - TRUTH.positions[t][None], axis=2)
        assert truth.radius.shape == (len(TRUTH.names),)
        assert away.min(axis=0).min() == pytest.approx(0.0)
        assert 0.0 < truth.radius.min() < truth.radius.max() < 0.3 * TRUTH.height


def test_a_frame_that_the_skeleton_does_not_have_is_empty() -> None:
    known, _ = held_against(PERFECT, TRUTH, *OBSERVED)
    source, mesh, projection = OBSERVED
    fields = {**PERFECT.plain(), **PERFECT.arrays(), "frames": (7, 8, 9)}
    truth = frame_truth(type(PERFECT)(**fields), known, {1: source[1]}, {1: mesh[1]}, {1: projection[1]}, (1,))
    assert (truth.known, len(truth.radius)) == (False, 0)
