"""Contract of the refits: closer to the frames, the reference stays at rest, and no frame needs another."""

import numpy as np
from stepwise import walk

from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.registration.pose import graph, pose
from kinetree.tasks.registration.refit import first_refit


def test_reference_stays_at_rest_through_all_passes() -> None:
    made = walk()
    for refit in (made.first_refit, made.second_refit, made.third_refit):
        rest = refit[made.reference.frame]
        assert rest.steps == 0
        assert np.array_equal(rest.translation, made.template.vertices[made.template.nodes])


def test_refitted_body_lies_closer_to_the_frames_than_the_tracked_one() -> None:
    made = walk()
    body = graph(made.template)

    def residual(poses):
        x = {t: shape(body, pose(p))[0] for t, p in poses.items()}
        return np.mean([residuals(x[t], np.array(m.vertices), m.faces).mean() for t, m in made.mesh.items()])

    assert residual(made.third_refit) < residual(made.tracking)


def test_frame_is_fitted_by_itself() -> None:
    made = walk()
    again = first_refit(made.mesh[4], made.template, made.repair[4], made.first_stiffness)
    assert again == made.first_refit[4]
