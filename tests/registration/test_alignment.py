"""Contract of alignment: where the body is in a frame, with a confidence of every vertex."""

import numpy as np
import pytest
from stepwise import aligned, bodied, generated, walk

from kinetree.tasks.registration.alignment import alignment


def test_in_the_reference_frame_the_body_is_the_reference() -> None:
    made = walk()
    here = made.alignment[made.reference.frame]
    assert here.vertices == pytest.approx(made.reference.vertices, abs=1e-9 * made.reference.size)
    assert here.stretch == pytest.approx(1.0)
    assert here.confidence.min() > 0.99


def test_body_that_is_followed_has_confidence() -> None:
    made = walk()
    for here in made.alignment.values():
        assert here.residual.mean() < 0.01 * made.reference.size
        assert here.uncovered < 0.02
        assert ((here.confidence >= 0) & (here.confidence <= 1)).all()
        assert np.median(here.confidence) > 0.9


def test_limb_that_is_not_in_the_frame_is_unreliable_and_the_rest_is_not() -> None:
    lost = {"dropped": [{"limb": "elbow_r", "begin": 3, "end": 4}]}
    made, body = aligned(generated(**lost)), bodied(**lost)
    rest = body.parts(made.reference.frame, np.array(made.reference.vertices))
    arm = rest == next(joint["part"] for joint in body.truth()["joints"] if joint["name"] == "elbow_r")
    assert made.reference.frame < 3
    assert np.median(made.alignment[4].confidence[arm]) < 0.3
    assert np.median(made.alignment[4].confidence[~arm]) > 0.9
    assert np.median(made.alignment[1].confidence[arm]) > 0.9


def test_frame_that_is_another_pose_entirely_is_unreliable() -> None:
    made = walk()
    strange = made.mesh[4].model_copy(update={"vertices": made.mesh[4].vertices + 0.3 * made.reference.size})
    here = alignment(strange, made.reference, made.deformation_graph, made.recovery, (made.refit[-1][4],))
    assert here.uncovered > 0.3
    assert here.confidence.max() < 0.1


def test_fixed_connectivity_is_taken_as_it_is() -> None:
    made = aligned(generated(connectivity="fixed", frames=3))
    assert made.reference.fixed
    for t, mesh in made.mesh.items():
        here = made.alignment[t]
        assert np.array_equal(here.vertices, mesh.vertices)
        assert not here.residual.any()
        assert (here.confidence == 1).all()
        assert here.uncovered == 0
    assert np.abs(made.alignment[0].stretch - 1).max() > 0
