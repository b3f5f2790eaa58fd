"""Contract of annuli: which move as one, at every threshold."""

import numpy as np
import pytest
from mesoscopic import mesoscopic
from pydantic import ValidationError

from kinetree.schemas.paper_2014.annuli import THRESHOLDS, AnnuliParams
from kinetree.tasks.paper_2014.annuli import annuli


def test_annulus_that_the_joint_crosses_is_the_only_one_that_is_not_rigid() -> None:
    here = mesoscopic()
    for (interval, cone), artifact in here.annuli.items():
        of_vertex = here.cone_consistency.annulus[cone, here.cone_consistency.rows(interval)]
        links = np.array([len(np.unique(here.body.label[of_vertex == k])) for k in artifact.annulus])
        for rigid in artifact.rigid:
            (joint,) = np.flatnonzero(~rigid)
            assert links[joint] == 2, "some of it follows either link"
            assert (links[:joint] == 1).all()


def test_by_the_ratio_alone_the_joint_is_one_annulus_nearer_to_the_body() -> None:
    here = mesoscopic()
    for (interval, cone), artifact in here.annuli.items():
        reference = here.interval_references[interval]
        alignments = {t: here.alignments[t] for t in reference.frames}
        params = AnnuliParams(joint="clustered")
        plain = annuli((interval, cone), here.cone_consistency, reference, alignments, params)
        assert np.flatnonzero(~plain.rigid[0]).tolist() == [k + 1 for k in np.flatnonzero(~artifact.rigid[0])]


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
