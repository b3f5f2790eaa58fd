"""Contract of annuli: which move as one, at every threshold."""

import numpy as np
from mesoscopic import made

from kinetree.schemas.paper_2014.annuli import LADDER, AnnuliParams
from kinetree.tasks.paper_2014.annuli import annuli


def test_annulus_at_the_joint_is_the_only_one_that_is_not_rigid() -> None:
    here = made()
    for (interval, cone), told in here.annuli.items():
        at = here.limb[interval, cone].ring
        for rigid in told.rigid:
            (joint,) = told.annulus[~rigid]
            radius = np.linalg.norm(here.body.V[at == joint], axis=1)
            assert radius.min() < 12.0 < radius.max(), "arms turn at 12"


def test_there_is_a_row_for_every_threshold() -> None:
    told = made().annuli[0, 0]
    assert tuple(told.theta) == LADDER
    assert told.rigid.shape == told.merge.shape == (len(LADDER), len(told.annulus))


def test_still_body_is_rigid_all_over() -> None:
    for told in made(still=True).annuli.values():
        assert told.rigid.all()
        assert (told.merge == 1.0).all()


def test_alignment_that_errs_makes_no_joint_of_a_body_that_lies_still() -> None:
    here = made()
    for moved, rigid in ((1.0, True), (9.0, False)):
        erring = {t: here.alignment[t].model_copy(update={"moved": moved}) for t in here.middle[0].frames}
        assert bool(annuli(here.limb[0, 0], here.middle[0], erring, AnnuliParams()).rigid.all()) is rigid
