"""Over which frames scores are taken."""

import numpy as np

from kinetree.tasks.numerics.structure.score_spans import score_spans


def test_a_single_take_is_all_frames_once() -> None:
    assert score_spans(7, None).tolist() == score_spans(7, [slice(0, 7)]).tolist() == [[0, 7]]


def test_of_several_takes_all_frames_come_first_and_then_each_take() -> None:
    spans = score_spans(9, [slice(0, 4), slice(4, 9)])
    assert spans.tolist() == [[0, 9], [0, 4], [4, 9]]
    assert spans.dtype == np.int64
