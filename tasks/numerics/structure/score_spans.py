"""The frames over which scores are taken: all, and each take by itself, so that what one take shows is not averaged away."""

from collections.abc import Sequence

import numpy as np

from kinetree.tasks.numerics.arrays import Ints


def score_spans(frames: int, takes: Sequence[slice] | None) -> Ints:
    """All frames, and where there are several takes each of them: a score is the largest of all rows.

    A joint that one of K takes turns would else lose √K of every root mean square over the frames, and its widest angle to
    the ranks that may be wrong.

    frames  : how many there are
    takes   : positions of the frames of each take, in order; None takes all as one
    returns : (span, 2) first frame and the one behind the last; a single row for a single take
    """
    whole = [[0, frames]]
    return np.array(whole + [[take.start, take.stop] for take in takes or () if len(takes or ()) > 1], np.int64)
