"""The figures of one sequence are those of its skeleton."""

import numpy as np
from results.rigged_bodies import spider
from results.sequence_tables import figures_of

from kinetree.schemas.results.evaluation import Summary


def test_counts_are_those_of_the_skeleton():
    body, figures = spider(), figures_of()
    assert (figures.joints, figures.leaves, figures.bones) == (2, 4, 6)
    assert (figures.frames, figures.outliers, figures.vertices) == (len(body.frames), 2, len(body.vertices))
    assert figures.height == np.ptp(body.vertices, axis=0).max()
    assert figures.confidence == np.mean(body.confidence)


def test_scores_are_there_where_a_truth_is():
    assert figures_of().found is None
    assert figures_of().truth == ""
    figures = figures_of(Summary(scored=5, found=4, error=None))
    assert (figures.scored, figures.found, figures.error) == (5, 4, None)


def test_the_picture_shows_the_body():
    picture = figures_of().picture
    assert picture.shape == (160, 160, 3)
    assert 0.02 < np.mean(picture.min(axis=2) < 255) < 0.9
