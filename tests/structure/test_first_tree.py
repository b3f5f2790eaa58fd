"""The tree of the first cut as the task gives it."""

import numpy as np
import pytest
from aligned_body import FIRST, given, rigid
from smeared import Frames, aligned, turning

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.structure.first_tree import FirstTree
from kinetree.schemas.structure.kinematic_tree import FirstTreeParams
from kinetree.tasks.methods import METHODS
from kinetree.tasks.numerics.structure import first_tree as numerics
from kinetree.tasks.structure.first_tree import first_tree, restored


def told(trust: float, **params: float) -> FirstTree:
    """Of a tube whose last joint only the frames show; vertices have so much confidence."""
    body, frames = aligned(turning()), Frames(turning())
    two = body._replace(label=(body.V[:, 2] > 0.0).astype(np.int64), R=body.R[:, :2], t=body.t[:, :2])
    reference, certain, leaves = given(body.V, body.F, body.x)
    trusted = {"confidence": np.full(len(body.V), trust)}
    alignment = {t: Alignment(**{**a.plain(), **a.arrays(), **trusted}) for t, a in certain.items()}
    shown = {FIRST + k: frames(k) for k in range(len(body.x))}
    mesh = {t: Mesh(vertices=V, faces=F, vertex_of_input=np.arange(len(V)), cleaning=Cleaning()) for t, (V, F) in shown.items()}
    return first_tree(reference, rigid(two, reference.frames), alignment, mesh, leaves, FirstTreeParams(**params))


@pytest.mark.parametrize("trust", [0.99, 1.0])
def test_other_tasks_read_what_the_numerics_gave(trust: float, monkeypatch: pytest.MonkeyPatch) -> None:
    made, whole = [], numerics.first_tree
    monkeypatch.setattr(numerics, "first_tree", lambda *a, **b: made.append(whole(*a, **b)) or made[0])
    tree, (before,) = restored(told(trust)), made
    assert (tree.ends, len(tree.laid.joint)) == ((1, 2) if trust < 1.0 else (0, 0))
    assert (tree.seen is None) == (trust == 1.0)
    for one, other in ((tree, before), (tree.graph, before.graph), (tree.laid, before.laid)):
        for name, value in one._asdict().items():
            if isinstance(value, np.ndarray):
                np.testing.assert_array_equal(value, getattr(other, name), err_msg=name)
            elif not isinstance(value, tuple):
                assert value == getattr(other, name), name


def test_whether_joints_at_ends_are_looked_for_can_be_set() -> None:
    assert told(0.99, end_joints=False).ends == 0


def test_it_is_made_beside_further_cuts() -> None:
    graph = METHODS["mesoscopic"]
    assert "further_cut" not in graph.until(["first_tree"]).by_name
    assert "first_tree" not in graph.until(["further_cut"]).by_name
