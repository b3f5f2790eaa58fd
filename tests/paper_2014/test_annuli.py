"""Contract of annuli: which move as one, at every threshold."""

import numpy as np
import pytest
from mesoscopic import mesoscopic
from pydantic import ValidationError

from kinetree.schemas.paper_2014.annuli import THRESHOLDS, AnnuliParams
from kinetree.tasks.paper_2014.annuli import annuli


def test_annulus_at_the_joint_is_the_only_one_that_is_not_rigid() -> None:
    here = mesoscopic()
    for (interval, cone), artifact in here.annuli.items():
        of_vertex = here.cone_consistency.annulus[cone, here.cone_consistency.rows(interval)]
        for rigid in artifact.rigid:
            (joint,) = artifact.annulus[~rigid]
            radius = np.linalg.norm(here.body.V[of_vertex == joint], axis=1)
            assert radius.min() < 12.0 < radius.max(), "arms turn at 12"


def test_annuli_are_of_the_interval_and_the_cone_of_the_index() -> None:
    for index, artifact in mesoscopic().annuli.items():
        assert (artifact.interval, artifact.cone) == index


def test_floor_of_zero_is_refused_because_an_annulus_without_errors_has_no_ratio() -> None:
    with pytest.raises(ValidationError, match="greater than 0"):
        AnnuliParams(floor=0.0)


def test_there_is_a_row_for_every_threshold() -> None:
    artifact = mesoscopic().annuli[0, 0]
    assert tuple(artifact.theta) == THRESHOLDS
    assert artifact.rigid.shape == artifact.merge_error.shape == (len(THRESHOLDS), len(artifact.annulus))


def test_body_at_rest_is_rigid_all_over() -> None:
    for artifact in mesoscopic(at_rest=True).annuli.values():
        assert artifact.rigid.all()
        assert (artifact.merge_error == 1.0).all()


def test_errors_of_the_alignment_make_no_joint_of_a_body_at_rest() -> None:
    here = mesoscopic()
    reference = here.interval_references[0]
    for residual, rigid in ((1.0, True), (9.0, False)):
        alignments = {t: here.alignments[t].model_copy(update={"rigid_residual": residual}) for t in reference.frames}
        artifact = annuli((0, 0), here.cone_consistency, reference, alignments, AnnuliParams())
        assert bool(artifact.rigid.all()) is rigid
