"""Contract of similarity: one with itself, the same in both directions."""

import numpy as np
from volumetric import volumetric


def test_similarity_is_symmetric_and_one_on_the_diagonal() -> None:
    S = np.array(volumetric().similarity.similarity)
    assert np.allclose(S, S.T)
    assert np.allclose(np.diag(S), 1.0)
    assert 0.5 < S.min() <= S.max() <= 1.0
