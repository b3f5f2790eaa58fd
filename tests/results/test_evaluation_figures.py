"""The picture of the comparison with the truth."""

from results.rigged_bodies import spider
from results.sample_report import judged, unjudged

from kinetree.schemas.input.sequence import Sequence
from kinetree.tasks.results.evaluation_figures import evaluation_figures
from kinetree.tasks.results.page.document import rendered
from kinetree.tasks.results.plots.evaluation import evaluation_figure


def test_one_picture_where_there_is_a_truth_and_none_elsewhere() -> None:
    body = spider()
    sequence = Sequence(frames=body.frames, fps=10.0, unit=body.unit)
    (file,) = evaluation_figures(judged(body), sequence).files()
    assert file == rendered(evaluation_figure(judged(body), 10.0))
    assert evaluation_figures(unjudged(body), sequence).files() == ()
