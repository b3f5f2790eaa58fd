"""Contract of the first fit: on the body in every frame, by the frame itself, and nothing twice."""

import numpy as np
from stepwise import walk

from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.registration.first_fit import first_fit
from kinetree.tasks.registration.pose import graph, pose


def test_reference_stays_at_rest() -> None:
    made = walk()
    rest = made.first_fit[made.reference.frame]
    assert np.array_equal(rest.translation, made.deformation_graph.vertices[made.deformation_graph.nodes])
    assert (rest.uncovered, rest.attempt) == (0.0, 0)


def test_body_lies_on_every_frame() -> None:
    made = walk()
    body = graph(made.deformation_graph)
    for t, mesh in made.mesh.items():
        x, _ = shape(body, pose(made.first_fit[t]))
        assert residuals(x, np.array(mesh.vertices), mesh.faces).mean() < 0.01 * made.reference.size


def test_what_was_tracked_with_all_samples_stays_as_it_is_and_is_measured() -> None:
    made = walk()
    t = max(made.mesh)
    whole = made.tracking[t].model_copy(update={"attempt": 3})
    found = first_fit(made.mesh[t], made.deformation_graph, whole)
    assert np.array_equal(found.rotation, whole.rotation)
    assert np.array_equal(found.translation, whole.translation)
    assert found.attempt == 2
    far = whole.model_copy(update={"translation": whole.translation + made.reference.size})
    assert found.uncovered < 0.1 < first_fit(made.mesh[t], made.deformation_graph, far).uncovered
