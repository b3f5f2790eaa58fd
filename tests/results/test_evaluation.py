"""A perfect skeleton, and what each fault of a skeleton costs."""

import numpy as np
import pytest
from results.true_skeletons import generated, held_against, observed, perfect

from kinetree.errors import InputError
from kinetree.pipeline import views
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.complete_skeleton import CompleteSkeleton
from kinetree.schemas.results.evaluation import EvaluationParams
from kinetree.schemas.results.truth import TruthParams
from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.evaluation import evaluation
from kinetree.tasks.results.formats.bvh import bvh
from kinetree.tasks.results.truth import numbered, synthetic, truth

RECIPE = generated()
PERFECT = perfect(RECIPE)
TRUTH = synthetic(RECIPE)
OBSERVED = observed(RECIPE)
NOBODY = truth.function(params=truth.params(), files=None)
HEIGHT = TRUTH.height
NOTHING = ({t: told.model_copy(update={"recipe": ""}) for t, told in OBSERVED[0].items()}, {}, {})
FIRST = PERFECT.kinds.index("joint")


def evaluated(skeleton=PERFECT, true=TRUTH, observed=NOTHING, **params):
    return evaluation(skeleton, *held_against(skeleton, true, *observed), EvaluationParams(**params))


def changed(**fields):
    return type(PERFECT)(**{**PERFECT.plain(), **PERFECT.arrays(), **fields})


def moved(joint, by):
    return changed(positions=PERFECT.positions + np.eye(len(PERFECT.names))[joint][:, None] * np.asarray(by))


def more(name, kind, parent, like, by):
    """One joint more, which goes where another goes."""
    wider = {}
    for field, spec in type(PERFECT).array_fields().items():
        value = getattr(PERFECT, field)
        axes = [k for k, dim in enumerate(spec.dims) if dim.name == "joint"]
        if axes:
            value = np.concatenate([value, value.take([like], axis=axes[0])], axis=axes[0])
        wider[field] = value
    wider["positions"][:, -1] += by
    names = {"names": (*PERFECT.names, name), "kinds": (*PERFECT.kinds, kind), "parents": (*PERFECT.parents, parent)}
    return type(PERFECT)(**{**PERFECT.plain(), **wider, **names})


def test_without_truth_there_is_nothing_to_say():
    result = evaluated(true=NOBODY)
    assert result.summary is None
    assert result.joints == ()
    assert views.remarks(result) == ()


def test_perfect_skeleton_is_found_whole():
    result = evaluated()
    s = result.summary
    assert s.scored == s.found == s.close == sum(TRUTH.scored) > 8
    assert (s.missing, s.spurious, s.excused, s.tree_edit, s.tree_shape) == (0, 0, 0, 0, 0)
    assert s.tips == s.tips_found > 3
    assert (s.percent, s.jitter, s.deviation) == (0.0, 0.0, 0.0)
    assert s.detection == 1.0
    assert s.distance == pytest.approx(0.0)
    assert s.chamfer_moving.j2j == pytest.approx(0.0, abs=1e-9)
    assert s.overlap_moving.iou == pytest.approx(100.0)
    assert s.length_variation < 60
    assert result.height == HEIGHT
    assert views.remarks(result) == (f"{s.scored} of {s.scored} joints found, mean error 0.00 % of the height",)


def test_generated_sequence_brings_its_own_truth_and_its_true_parts():
    result = evaluated(true=NOBODY, observed=OBSERVED)
    assert result.truth == "synth"
    assert result.summary.found == result.summary.scored
    parts = result.summary.parts
    assert parts.parts == parts.true_parts == result.summary.scored + 1
    assert parts.rand > 0.98
    assert parts.adjusted_rand > 0.9
    assert parts.mean_iou > 0.85


def test_one_part_for_the_whole_body_agrees_with_the_true_parts_by_chance_alone():
    whole = changed(label=np.zeros_like(PERFECT.label))
    parts = evaluated(skeleton=whole, observed=OBSERVED).summary.parts
    assert parts.parts == 1
    assert parts.adjusted_rand == pytest.approx(0.0)
    assert parts.mean_iou < 0.1


def test_joint_that_is_off_is_off_by_that_much():
    result = evaluated(skeleton=moved(FIRST, [0, 0.03 * HEIGHT, 0]))
    row = next(j for j in result.joints if j.found == PERFECT.names[FIRST])
    assert row.percent == pytest.approx(3.0)
    assert (row.mean, row.deviation, row.worst) == pytest.approx((0.03 * HEIGHT, 0.0, 0.03 * HEIGHT))
    s = result.summary
    assert (s.found, s.close) == (s.scored, s.scored - 1)
    assert s.percent == pytest.approx(3.0 / s.scored)
    assert s.jitter == pytest.approx(0.0, abs=1e-6)


def test_joint_that_is_too_far_off_is_missing_and_spurious():
    result = evaluated(skeleton=moved(FIRST, [0.4 * HEIGHT, 0.4 * HEIGHT, 0]))
    s = result.summary
    assert (s.found, s.missing, s.spurious) == (s.scored - 1, 1, 1)
    assert result.spurious == (PERFECT.names[FIRST],)
    lost = next(j for j in result.joints if j.name == PERFECT.names[FIRST])
    assert lost.found is None
    assert lost.nearest > 5.0
    assert f"missing: {lost.name}" in views.remarks(result)
    assert "1 spurious" in views.remarks(result)[0]


def test_joint_too_many_is_spurious_and_one_edit_of_the_tree():
    result = evaluated(skeleton=more("extra", "joint", FIRST, FIRST, [0, 0, 0.3 * HEIGHT]))
    s = result.summary
    assert result.spurious == ("extra",)
    assert (s.found, s.missing, s.tree_edit, s.tree_shape) == (s.scored, 0, 1, 1)
    assert s.percent == 0.0
    assert s.overlap_moving.recall == pytest.approx(100.0)
    assert s.overlap_moving.precision < 100.0


def test_spurious_joints_are_duplicates_at_branches_duplicates_elsewhere_or_false():
    knee, hips = PERFECT.names.index("knee_l"), PERFECT.names.index("hips")
    for joint, by, counts, true in (
        (knee, 0.02, (0, 1, 0), "knee_l"),
        (hips, 0.02, (1, 0, 0), "hips"),
        (knee, 0.2, (0, 0, 1), ""),
    ):
        result = evaluated(skeleton=more("extra", "joint", joint, joint, [0, by * HEIGHT, 0]))
        s = result.summary
        assert (s.branch_duplicates, s.duplicates, s.false) == counts
        assert (result.spurious, result.duplicate_of) == (("extra",), (true,))
    assert evaluated().summary.tip_percent == pytest.approx(0.0)


def test_error_of_the_ends_of_bones_is_apart_from_that_of_joints():
    tip = PERFECT.kinds.index("leaf")
    s = evaluated(skeleton=moved(tip, [0, 0, 0.02 * HEIGHT])).summary
    assert s.percent == 0.0
    assert s.tip_percent == pytest.approx(2.0 / s.tips_found)


def test_joint_that_hangs_on_the_wrong_part_is_two_edits():
    elsewhere = PERFECT.names.index("knee_l"), PERFECT.names.index("elbow_r")
    parents = list(PERFECT.parents)
    parents[elsewhere[0]] = elsewhere[1]
    s = evaluated(skeleton=changed(parents=tuple(parents))).summary
    assert (s.found, s.spurious, s.tree_edit) == (s.scored, 0, 2)


def test_end_of_a_bone_too_many_is_no_joint_too_many():
    s = evaluated(skeleton=more("extra", "leaf", FIRST, FIRST, [0, 0, 0.3 * HEIGHT])).summary
    assert (s.spurious, s.tree_edit) == (0, 0)


def test_joint_found_where_one_hardly_turns_is_excused():
    scored = tuple(s and n != PERFECT.names[FIRST] for n, s in zip(TRUTH.names, TRUTH.scored, strict=True))
    s = evaluated(true=TRUTH.model_copy(update={"scored": scored})).summary
    assert s.scored == sum(TRUTH.scored) - 1
    assert (s.missing, s.spurious, s.excused, s.tree_edit) == (0, 0, 1, 0)


def test_order_of_the_joints_does_not_matter():
    order = np.r_[0, np.random.default_rng(1).permutation(np.arange(1, len(PERFECT.names)))]
    place = np.argsort(order)
    shuffled = {}
    for field, spec in type(PERFECT).array_fields().items():
        value = getattr(PERFECT, field)
        for axis, dim in enumerate(spec.dims):
            value = value.take(order, axis=axis) if dim.name == "joint" else value
        shuffled[field] = value
    shuffled["influence"] = place[PERFECT.influence].astype(np.int32)
    shuffled["label"] = np.where(PERFECT.label < 0, -1, place[PERFECT.label]).astype(np.int32)
    result = {
        "names": tuple(PERFECT.names[j] for j in order),
        "kinds": tuple(PERFECT.kinds[j] for j in order),
        "parents": tuple(-1 if PERFECT.parents[j] < 0 else int(place[PERFECT.parents[j]]) for j in order),
    }
    here = evaluated(observed=OBSERVED)
    there = evaluated(skeleton=type(PERFECT)(**{**PERFECT.plain(), **shuffled, **result}), observed=OBSERVED)
    assert there.joints == here.joints
    assert there.summary.parts == here.summary.parts
    assert there.summary.tree_edit == here.summary.tree_edit


def test_shaking_joint_shows_in_the_jitter():
    shake = PERFECT.positions.copy()
    shake[::2, FIRST, 0] += 0.01 * HEIGHT
    s = evaluated(skeleton=changed(positions=shake)).summary
    assert s.jitter_percent == pytest.approx(2.0 / np.sqrt(s.scored))
    assert s.length_variation > 0


def test_one_rigid_part_is_evaluated_and_has_found_nothing():
    root = {f: getattr(PERFECT, f) for f in type(PERFECT).array_fields()}
    for field, spec in type(PERFECT).array_fields().items():
        for axis, dim in enumerate(spec.dims):
            root[field] = root[field].take([0], axis=axis) if dim.name == "joint" else root[field]
    root["influence"], root["label"] = np.zeros_like(PERFECT.influence), np.zeros_like(PERFECT.label)
    one = type(PERFECT)(**{**PERFECT.plain(), **root, "names": ("root",), "kinds": ("root",), "parents": (-1,)})
    s = evaluated(skeleton=one).summary
    assert (s.found, s.missing, s.spurious) == (0, s.scored, 0)
    assert s.percent is None
    assert s.jitter is None
    assert s.chamfer_moving.j2j > 10.0
    assert s.tree_edit == s.scored


def test_frames_are_compared_by_their_numbers():
    selected = {f: getattr(PERFECT, f) for f in type(PERFECT).array_fields()}
    for field, spec in type(PERFECT).array_fields().items():
        if spec.dims[0].name == "frame":
            selected[field] = selected[field][1::2]
    result = evaluated(skeleton=type(PERFECT)(**{**PERFECT.plain(), **selected, "frames": (1, 3, 5)}))
    assert result.summary.percent == 0.0
    told = "3 measured frames are compared; synth has 6: interpolated and missing ones do not count"
    assert views.remarks(result)[-1] == told


def test_interpolated_frames_are_not_evaluated():
    reads = {argument.artifact for argument in evaluation.arguments}
    assert Skeleton in reads
    assert CompleteSkeleton not in reads


def test_bvh_of_a_skeleton_is_its_truth(tmp_path):
    carried = PERFECT.positions.copy()
    for j, p in enumerate(PERFECT.parents):
        if p >= 0:
            carried[:, j] = carried[:, p] + PERFECT.rotation[:, p] @ (PERFECT.rest[j] - PERFECT.rest[p])
    skeleton = changed(positions=carried)
    path = tmp_path / "walk.bvh"
    path.write_text(bvh(skeleton)[0])
    true = truth.function(params=TruthParams(file=str(path)), files=None)
    result = evaluated(skeleton=skeleton, true=true)
    assert result.summary.found == result.summary.scored > 5
    assert result.summary.percent < 1e-3
    assert result.summary.spurious == 0


def numbered_from(first, last, frames):
    """The sources of some frames of a series."""
    return {t: Source(content=str(t), path="x", series=(first, last)) for t in frames}


def test_truth_without_numbers_begins_with_the_sequence_where_both_are_as_long():
    given = numbered(TRUTH, numbered_from(1, 6, (2, 4)))
    assert given.frames == (1, 2, 3, 4, 5, 6)
    assert numbered(TRUTH, numbered_from(0, 3, (0, 3))) == TRUTH
    stated = TRUTH.model_copy(update={"numbered": True})
    assert numbered(stated, numbered_from(1, 6, (2, 4))) == stated
    with pytest.raises(InputError, match=r"6 frames without numbers, but the sequence has frames 1 to 5; set truth\.first to"):
        numbered(TRUTH, numbered_from(1, 5, (2, 4)))


def test_truth_with_too_few_frames_is_refused():
    fewer = {name: getattr(TRUTH, name)[:3] for name in ("positions", "vertices")}
    short = TRUTH.model_copy(update={"frames": (0, 1, 2), **fewer})
    with pytest.raises(InputError, match=r"frames 0 to 2, but 3 of the 6 frames of the sequence are missing, the first is 3"):
        evaluated(true=short)


def test_truth_of_other_frames_altogether_is_refused():
    with pytest.raises(InputError, match="but 6 of the 6 frames of the sequence are missing"):
        evaluated(true=TRUTH.model_copy(update={"frames": tuple(range(100, 106))}))


def test_truth_of_another_sequence_is_refused():
    with pytest.raises(InputError, match="do not lie in the body: it is the truth of another sequence"):
        evaluated(true=TRUTH.model_copy(update={"positions": TRUTH.positions + 10 * HEIGHT}))


def test_truth_in_another_unit_is_converted_if_both_say_so_and_refused_if_it_cannot_be_seen():
    metres = TRUTH.model_copy(update={"positions": TRUTH.positions / 1000, "height": HEIGHT / 1000, "unit": "m"})
    assert PERFECT.unit == "mm"
    assert evaluated(true=metres).summary.percent == pytest.approx(0.0, abs=1e-9)
    with pytest.raises(InputError, match=r"true joints measure .*, but the body .*; if the unit differs, set truth\.unit"):
        evaluated(true=metres.model_copy(update={"unit": None}))
    with pytest.raises(InputError, match="synth is in ell and the sequence in mm, but 'ell' cannot be converted"):
        evaluated(true=metres.model_copy(update={"unit": "ell"}))


def test_truth_at_another_frame_rate_is_refused():
    with pytest.raises(InputError, match="frames are compared by number, so resample the truth, or correct sequence.fps"):
        evaluated(true=TRUTH.model_copy(update={"fps": TRUTH.fps * 4}))


def test_height_that_nobody_says_is_the_longest_side_of_the_body():
    result = evaluated(true=TRUTH.model_copy(update={"height": None}))
    assert result.height == pytest.approx(np.ptp(PERFECT.vertices, axis=0).max())
