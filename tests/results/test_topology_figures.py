"""Pictures of topology are complete files, and depend on the frames that are chosen."""

from results.sample_report import page_artifacts

from kinetree.schemas.results.excerpt import ExcerptParams


def test_correlation_is_lines_and_mu_a_surface() -> None:
    figures = page_artifacts(ExcerptParams(views=1))["topology_figures"]
    assert [b"<image" in file for file in figures.files()] == [False, True]
    assert sum(map(len, figures.files())) == len(figures.content)


def test_more_views_make_another_picture_of_mu_and_the_same_curve() -> None:
    one, two = (page_artifacts(ExcerptParams(views=views))["topology_figures"].files() for views in (1, 2))
    assert one[0] == two[0]
    assert one[1] != two[1]
