"""What is said and drawn of the alignment."""

import numpy as np
import pytest
from results.rigged_bodies import skinned, spider
from results.sample_report import UP, artifacts

from kinetree.schemas.results.alignment_figures import AlignmentFigures
from kinetree.schemas.results.excerpt import Excerpt
from kinetree.tasks.results.alignment_figures import alignment_figures

CHOSEN = Excerpt(frames=(0,), alike=(0,), pictured=(0,))


def of(away: float = 0.0, anew: bool = False) -> AlignmentFigures:
    """The figures where all aligned meshes are moved along z."""
    content = artifacts(anew=anew)
    moved = {f: a.model_copy(update={"vertices": a.vertices + [0, 0, away]}) for f, a in content["alignment"].items()}
    return alignment_figures(
        skeleton=spider(), excerpt=CHOSEN, connectivity=content["connectivity"], up_direction=UP, alignment=moved
    )


def test_residuals_are_drawn_only_where_something_was_aligned() -> None:
    assert of().files() == ()
    assert [file[:4] for file in of(anew=True).files()] == [b"<?xm"]


def test_skin_is_as_far_as_the_aligned_meshes_are_moved() -> None:
    size = float(np.linalg.norm(np.ptp(spider().vertices, axis=0)))
    assert of().skin_distance == pytest.approx(0.0, abs=1e-9)
    assert of(away=0.1 * size).skin_distance == pytest.approx(0.1)


def test_reference_is_the_frame_in_which_the_body_is_at_rest() -> None:
    body = spider()
    nearest = min(range(len(body.frames)), key=lambda t: float(np.abs(skinned(body)[t] - body.vertices).max()))
    assert of().reference == body.frames[nearest]
