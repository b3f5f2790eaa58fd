"""Laws of the fit of a model to a frame: a tube that bends is found again."""

import numpy as np
from limbs import bent, tube

from kinetree.tasks.numerics.paper_2009 import model_fit
from kinetree.tasks.numerics.paper_2009.graph_body import graph_body
from kinetree.tasks.numerics.paper_2009.graph_deformation import Forces
from kinetree.tasks.numerics.paper_2009.graph_loops import end_branches
from kinetree.tasks.numerics.paper_2009.perg import perg
from kinetree.tasks.numerics.paper_2009.reeb_graph import reeb_graph
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.structure.articulated_frame import FramePose, SkinnedBody
from kinetree.tasks.numerics.structure.surface_matches import searched, uncovered


def test_tube_that_bends_is_followed_by_forces_and_laid_on_its_surface() -> None:
    V, F = tube(20, 60, flat=1.0)
    W, f = bent(V, 0.5), V[:, 2].copy()
    ends = np.array([int(f.argmin()), int(f.argmax())])
    one, other = (perg(X, F, reeb_graph(X, F, f, 4), ends, start=0) for X in (V, W))
    body = graph_body(V, F, one.node, one.edge, one.loop, one.area, one.end, one.of_vertex)
    skin = SkinnedBody.of(V, F, body.bound, body.weight, body.joint, body.parents)
    model = model_fit.Model(body.node, body.parents, body.joint, body.branch, body.end, skin.size)
    branch = end_branches(len(other.node), other.edge, other.end)
    lines = model_fit.branch_lines(other.node, other.edge, branch, other.end)
    target = model_fit.TargetGraph(other.node, np.arange(2), lines)
    rest = model_fit.at_rest(model)
    assert np.allclose(model_fit.posed_surface(model, skin, rest), V)
    drawn = model_fit.drawn(model, rest, target, Forces(), branches=True)
    laid = model_fit.laid_on(model, skin, drawn, Target.of(W, F, skin.size), 0.02)
    off = [np.linalg.norm(model_fit.posed_surface(model, skin, p) - W, axis=1).mean() for p in (rest, drawn, laid)]
    assert off[2] < 0.5 * off[1] < 0.5 * off[0]
    assert off[2] < 0.1
    pose = FramePose(laid.rotation, laid.position[0])
    frame = Target.of(W, F, skin.size, 500)
    assert model_fit.uncovered_share(skin, pose, frame) == uncovered(skin, frame, searched(skin, pose, frame)).mean()
    mirrored = drawn._replace(position=drawn.position * [1.0, -1.0, 1.0])
    best = model_fit.best_laid(model, skin, [mirrored, drawn], Target.of(W, F, skin.size), 0.02)
    assert np.linalg.norm(model_fit.posed_surface(model, skin, best) - W, axis=1).mean() < 0.15
