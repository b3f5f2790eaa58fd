"""Contract of tracking: at rest in the reference, on the body in every other frame, and a chain that goes on."""

import numpy as np
from stepwise import along, walk

from kinetree.tasks.numerics.registration.deformation import shape
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.registration.pose import graph, pose
from kinetree.tasks.registration.tracking import tracking


def test_reference_is_at_rest_and_every_other_frame_is_reached_from_its_neighbour() -> None:
    made = walk()
    rest = made.tracking[made.reference.frame]
    assert (rest.steps, rest.uncovered, rest.attempt) == (0, 0.0, 0)
    assert np.array_equal(rest.translation, made.deformation_graph.vertices[made.deformation_graph.nodes])
    for t, here in made.tracking.items():
        assert here.steps == abs(t - made.reference.frame)
        if here.steps > 0:
            before = made.tracking[made.reference.previous(t)]
            assert np.array_equal(here.earlier_rotation, before.rotation)
            assert np.array_equal(here.earlier_translation, before.translation)


def test_body_lies_on_every_frame() -> None:
    made = walk()
    body = graph(made.deformation_graph)
    for t, mesh in made.mesh.items():
        x, _ = shape(body, pose(made.tracking[t]))
        assert residuals(x, np.array(mesh.vertices), mesh.faces).mean() < 0.01 * made.reference.size


def test_usual_is_the_least_uncovered_on_the_way_but_for_the_reference() -> None:
    made = walk()
    for t, here in made.tracking.items():
        on_the_way, at = [], t
        while at != made.reference.frame:
            on_the_way.append(made.tracking[at].uncovered)
            at = made.reference.previous(at)
        assert here.usual == min(on_the_way, default=0.0)


def test_frame_that_is_another_pose_entirely_leaves_much_uncovered_and_the_chain_recovers() -> None:
    made = walk()
    meshes = dict(made.mesh)
    last = max(meshes)
    strange = last - 1
    turned = np.array(meshes[strange].vertices) @ np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    meshes[strange] = meshes[strange].model_copy(update={"vertices": turned + 0.3 * made.reference.size})
    again = along(tracking, made.reference, list(meshes), mesh=meshes, deformation_graph=made.deformation_graph)
    assert again[strange].uncovered > 0.1
    assert again[last].uncovered < 0.1
