"""Contract of integration: a joint of one interval is a joint of all."""

import numpy as np
from mesoscopic import made

from kinetree.pipeline import views
from kinetree.tasks.paper_2014.integration import integration


def test_all_cones_have_the_joint_that_their_intervals_found() -> None:
    here = made()
    assert here.integration.rigid.shape[0] == 3
    assert ((~here.integration.rigid).sum(axis=1) == 1).all()
    assert (here.integration.clusters == 6).all()
    assert "6" in views.remarks(here.integration)[0]


def test_joint_that_only_one_interval_shows_is_kept() -> None:
    here, still = made(), made(still=True)
    clusters = [here.annuli[0, c] for c in range(3)] + [still.annuli[1, c] for c in range(3)]
    assert (integration(here.consistency, tuple(clusters)).rigid == here.integration.rigid).all()


def test_one_threshold_is_taken_without_a_word() -> None:
    here = made()
    one = {"theta": np.array([1.2])}
    single = [a.model_copy(update={**one, "rigid": a.rigid[:1], "merge": a.merge[:1]}) for a in here.annuli.values()]
    told = integration(here.consistency, tuple(single))
    assert told.theta == 1.2
    assert views.remarks(told) == ()


def test_no_cones_no_areas() -> None:
    here = made()
    none = here.consistency.model_copy(update={"ring": here.consistency.ring[:0], "leaf": here.consistency.leaf[:, :0]})
    assert integration(none, ()).rigid.shape[0] == 0
