"""The comparison with the truth, drawn for the report."""

from kinetree.pipeline.task import task
from kinetree.schemas.input.sequence import Sequence
from kinetree.schemas.results.evaluation import Evaluation
from kinetree.schemas.results.evaluation_figures import EvaluationFigures
from kinetree.tasks.results.page.alternatives import evaluation_words
from kinetree.tasks.results.page.chapters import CaptionedFigure, rendered_figures
from kinetree.tasks.results.plots.evaluation import evaluation_figure


@task()
def evaluation_figures(evaluation: Evaluation, sequence: Sequence) -> EvaluationFigures:
    """Draws the error of every joint over time (2014, Fig. 16)."""
    if evaluation.summary is None:
        return EvaluationFigures(**rendered_figures([]))
    caption = "Error of every joint over time with its mean and deviation (2014, Fig. 16); below, the measures of 2009."
    figure = evaluation_figure(evaluation, sequence.fps)
    return EvaluationFigures(**rendered_figures([CaptionedFigure(figure, caption, evaluation_words(evaluation))]))
