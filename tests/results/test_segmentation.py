"""Labels on the input's own vertices, gathered."""

import numpy as np
from results.plain_names import plain
from results.rigged_bodies import skinned, spider

from kinetree.pipeline import views
from kinetree.schemas.registration.alignment import Alignment
from kinetree.schemas.registration.projection import Projection
from kinetree.tasks.results.segmentation import segmentation


def gathered(shift=0.0):
    body = spider(frames=tuple(range(3, 15)))
    n = len(body.vertices)
    zero, one = np.zeros(n), np.ones(n)
    aligned = {
        frame: Alignment(vertices=V + [shift, 0, 0], residual=zero, stretch=one, confidence=one, uncovered=0.0)
        for frame, V in zip(body.frames, skinned(body), strict=True)
    }
    counts = {frame: 2 + frame for frame in body.frames}
    projected = {
        frame: Projection(face=np.full(k, frame), share=np.eye(3)[np.zeros(k, int)], distance=np.zeros(k))
        for frame, k in counts.items()
    }
    return (
        body,
        counts,
        segmentation(body, plain(body, names=tuple(f"{name}_renamed" for name in body.names)), aligned, projected),
    )


def test_every_frame_has_as_many_labels_as_its_file_has_vertices():
    body, counts, segments = gathered()
    assert segments.frame.tolist() == list(body.frames)
    for i, frame in enumerate(body.frames):
        labels = segments.label[segments.begin[i] : segments.end[i]]
        assert labels.tolist() == [body.label[body.faces[frame, 0]]] * counts[frame]
    assert segments.end[-1] == len(segments.label)
    assert segments.names == tuple(f"{name}_renamed" for name in body.names)


def test_error_is_the_distance_between_skinned_and_aligned():
    _, _, segments = gathered(shift=0.25)
    np.testing.assert_allclose([segments.error, segments.error_95], 0.25, rtol=1e-6)
    (remark,) = views.remarks(segments)
    assert remark.endswith("and the aligned meshes: 0.25 mm root mean square, 95 % below 0.25 mm")
