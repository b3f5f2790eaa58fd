"""Contract of integration: a joint of one interval is a joint of all."""

import numpy as np
from mesoscopic import mesoscopic

from kinetree.pipeline import views
from kinetree.tasks.paper_2014.integration import integration


def test_all_cones_have_the_joint_of_their_intervals() -> None:
    here = mesoscopic()
    assert here.integration.rigid.shape[0] == 3
    assert ((~here.integration.rigid).sum(axis=1) == 1).all()
    assert (here.integration.clusters == 6).all()
    assert "6" in views.remarks(here.integration)[0]


def test_joint_that_only_one_interval_shows_is_kept() -> None:
    here, at_rest = mesoscopic(), mesoscopic(at_rest=True)
    clusters = [here.annuli[0, c] for c in range(3)] + [at_rest.annuli[1, c] for c in range(3)]
    assert (integration(here.cone_consistency, tuple(clusters)).rigid == here.integration.rigid).all()


def test_single_threshold_is_taken_without_a_remark() -> None:
    here = mesoscopic()
    one = {"theta": np.array([1.2])}
    single = [
        a.model_copy(update={**one, "rigid": a.rigid[:1], "merge_error": a.merge_error[:1]}) for a in here.annuli.values()
    ]
    joined = integration(here.cone_consistency, tuple(single))
    assert joined.theta == 1.2
    assert views.remarks(joined) == ()


def test_order_of_the_annuli_does_not_matter() -> None:
    here = mesoscopic()
    assert integration(here.cone_consistency, tuple(here.annuli.values())[::-1]) == here.integration


def test_no_cones_no_areas() -> None:
    here = mesoscopic()
    none = here.cone_consistency.model_copy(
        update={"annulus": here.cone_consistency.annulus[:0], "leaf": here.cone_consistency.leaf[:, :0]}
    )
    assert integration(none, ()).rigid.shape[0] == 0
