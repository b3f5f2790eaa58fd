"""Contract of tracking: at rest in the reference, near the body in every other frame, and a chain that goes on."""

import sys
from typing import Any

import numpy as np
import pytest
from limbs import rotation
from pydantic import ValidationError
from shipped import FITTING
from stepwise import along, walk

from kinetree.schemas.array import Floats
from kinetree.schemas.registration.reference_colour import ReferenceColour
from kinetree.schemas.registration.take_entries import TakeEntries
from kinetree.schemas.registration.tracking import Tracking, TrackingParams
from kinetree.schemas.registration.vertex_colour import VertexColour
from kinetree.schemas.topology.extrema import Extrema
from kinetree.tasks.numerics.registration import first_fit as numeric_first_fit
from kinetree.tasks.numerics.registration import recovery as numeric_recovery
from kinetree.tasks.numerics.registration import tracking as numeric_tracking
from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation import Pose, shape
from kinetree.tasks.numerics.registration.first_fit import last_steps
from kinetree.tasks.numerics.registration.frame_confidence import residuals
from kinetree.tasks.numerics.registration.limb_swing import LimbSwingSettings, swings, with_two_exchanged
from kinetree.tasks.numerics.registration.tracking import entered
from kinetree.tasks.registration.first_fit import first_fit
from kinetree.tasks.registration.pose import fit_settings, graph, pose
from kinetree.tasks.registration.recovery import recovery
from kinetree.tasks.registration.tracking import tracking


def test_reference_is_at_rest_and_every_other_frame_is_reached_from_its_neighbour() -> None:
    made = walk()
    rest = made.tracking[made.reference.frame]
    assert (rest.steps, rest.unexplained, rest.attempt) == (0, 0.0, 0)
    assert np.array_equal(rest.translation, made.deformation_graph.vertices[made.deformation_graph.nodes])
    for t, here in made.tracking.items():
        assert here.frame == t
        if here.steps > 0:
            before = made.tracking[made.tracking_order.previous(t)]
            assert (here.steps, here.earlier_frame) == (before.steps + 1, before.frame)
            assert np.array_equal(here.earlier_rotation, before.rotation)
            assert np.array_equal(here.earlier_translation, before.translation)


def test_body_lies_near_every_frame_and_most_frames_need_few_points_alone() -> None:
    made = walk()
    body = graph(made.deformation_graph)
    for t, mesh in made.mesh.items():
        x, _ = shape(body, pose(made.tracking[t]))
        assert residuals(x, np.array(mesh.vertices), mesh.faces).mean() < 0.015 * made.reference.size
    assert sum(here.attempt > 0 for here in made.tracking.values()) < len(made.mesh) / 2


def test_usual_is_the_smallest_share_unexplained_on_the_way_but_for_the_reference() -> None:
    made = walk()
    for t, here in made.tracking.items():
        on_the_way, at = [], t
        while at != made.reference.frame:
            on_the_way.append(made.tracking[at].unexplained)
            at = made.tracking_order.previous(at)
        assert here.usual == min(on_the_way, default=0.0)


def test_frame_that_is_another_pose_entirely_leaves_much_uncovered_and_the_chain_recovers() -> None:
    made = walk()
    meshes = dict(made.mesh)
    last = max(meshes)
    strange = last - 1
    turned = np.array(meshes[strange].vertices) @ np.array([[0.0, 0, 1], [0, 1, 0], [-1, 0, 0]])
    meshes[strange] = meshes[strange].model_copy(update={"vertices": turned + 0.3 * made.reference.size})
    again = along(
        tracking,
        made.tracking_order,
        list(meshes),
        mesh=meshes,
        deformation_graph=made.deformation_graph,
        take_entries=made.take_entries,
        index=made.numbers,
        params=TrackingParams(),
        tips=made.extrema,
    )
    assert again[strange].attempt > 0, "few points show that a limb is lost, and all samples are asked"
    assert again[strange].unexplained > 0.1
    assert again[last].unexplained < 0.1


def test_a_limb_far_from_where_it_was_is_brought_to_where_the_frame_shows_it_and_needs_few_points_alone() -> None:
    made = walk()
    rest, at = made.tracking[made.reference.frame], made.reference.frame + 1
    stems, body = np.array(made.reference.stems), graph(made.deformation_graph)
    raised = (stems - stems[:, :1]) @ rotation((1, 0, 0), 2.0).T + stems[:, :1]
    elsewhere = swings(body, pose(rest), stems, raised, body.V[body.sample].mean(axis=0))[0]
    assert elsewhere is not None
    last = rest.model_copy(update={"rotation": elsewhere.rotation, "translation": elsewhere.translation})

    def from_there(limbs: Floats) -> Tracking:
        rest = made.deformation_graph.model_copy(update={"stems": limbs})
        return tracking(made.mesh[at], rest, made.take_entries, last, TrackingParams(), (at,), made.extrema[at])

    unknown, known = (from_there(limbs) for limbs in (stems[:0], stems))
    assert unknown.attempt > 0
    assert known.attempt == 0
    assert known.unexplained < 0.003


@pytest.mark.parametrize("fitted", ["by few points", "with all samples"])
def test_legs_that_the_pose_before_had_exchanged_are_put_right_and_the_frame_is_fitted_with_all_samples_later(
    monkeypatch: pytest.MonkeyPatch, fitted: str
) -> None:
    made = walk()
    rest, at = made.tracking[made.reference.frame], made.reference.frame + 1
    stems, body = np.array(made.reference.stems), graph(made.deformation_graph)
    every = LimbSwingSettings(stages=((40, np.inf),), ways=1)
    exchanged = with_two_exchanged(body, pose(rest), stems, np.array(made.extrema[at].stems), every)[0]
    last = rest.model_copy(update={"rotation": exchanged.rotation, "translation": exchanged.translation})
    task, by_few = sys.modules["kinetree.tasks.registration.tracking"], fitted == "by few points"
    monkeypatch.setattr(task, "is_lost", lambda *given: not by_few)
    if not by_few:
        for one in (task, numeric_tracking):
            monkeypatch.setattr(one, "swings", lambda *given: [])

    def from_there(limbs: Floats) -> Tracking:
        graph_of = made.deformation_graph.model_copy(update={"stems": limbs})
        return tracking(made.mesh[at], graph_of, made.take_entries, last, TrackingParams(), (at,), made.extrema[at])

    def off(here: Tracking) -> float:
        apart = shape(body, pose(here))[0] - shape(body, pose(made.tracking[at]))[0]
        return float(np.linalg.norm(apart, axis=1).max()) / body.size

    unknown, known = (from_there(limbs) for limbs in (stems[:1], stems))
    assert (unknown.attempt == 0) == by_few
    assert off(unknown) > 0.1
    assert off(known) < 0.05
    assert known.attempt == 0


@pytest.mark.parametrize("where", ["in colour", "where a take is entered"])
def test_a_limb_far_away_is_also_reached_by_fits_with_all_samples(where: str) -> None:
    made = walk()
    rest, at = made.tracking[made.reference.frame], made.reference.frame + 1
    far = np.array([0.0, 0.0, 0.4 * made.reference.size])
    mesh = made.mesh[at].model_copy(update={"vertices": made.mesh[at].vertices + far})
    centre = tuple(np.array(made.extrema[at].centre) + far)
    tips = made.extrema[at].model_copy(update={"stems": made.extrema[at].stems + far, "centre": centre})
    grey = {
        "vertex_colour": VertexColour(colour=np.full((len(mesh.vertices), 3), 128, np.uint8)),
        "reference_colour": ReferenceColour(colour=np.full((len(made.reference.vertices), 3), 128, np.uint8)),
    }
    places = {"rotation": np.eye(3)[None], "shift": np.zeros((1, 3)), "distance": np.zeros(1)}
    entered_here = TakeEntries(frames=(at,), before=(made.reference.frame,), entry=np.zeros(1, np.int32), **places)
    entries, colours = (made.take_entries, grey) if where == "in colour" else (entered_here, {})

    def by(limbs: Extrema) -> Tracking:
        return tracking(mesh, made.deformation_graph, entries, rest, TrackingParams(), (at,), limbs, **colours)

    blind, seeing = by(tips.model_copy(update={"stems": tips.stems[:0]})), by(tips)
    assert seeing.unexplained < 0.01 < blind.unexplained


OTHERS = TrackingParams(
    steps=2, stiffness=(0.3, 0.1), reach=(0.05, 0.02), scale=(0.03, 0.01), point_weight=(0.04, 0.01), solver_steps=5
)


def test_every_parameter_reaches_every_fit_with_all_samples(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    made = walk()
    fits: list[Any] = []
    fitted = numeric_tracking.tracking

    def listening(body: Any, earlier: Any, neighbour: Any, target: Any, fitting: Any, *usual: Any, **others: Any) -> Any:
        fits.append(fitting)
        return fitted(body, earlier, neighbour, target, fitting, *usual, **others)

    monkeypatch.setattr(numeric_tracking, "tracking", listening)
    monkeypatch.setattr(numeric_first_fit, "tracking", listening)
    monkeypatch.setattr(numeric_recovery, "tracking", listening)
    meshes = {**made.mesh, 1: made.mesh[1].model_copy(update={"vertices": made.mesh[1].vertices + 0.3 * made.reference.size})}
    first = along(
        tracking,
        made.tracking_order,
        [0, 1],
        mesh=meshes,
        deformation_graph=made.deformation_graph,
        take_entries=made.take_entries,
        index=made.numbers,
        params=OTHERS,
        tips=made.extrema,
    )
    assert [values(fitting) for fitting in fits] == [OTHERS.model_dump()], "of a frame that few points lose"
    near = first[0].model_copy(update={"attempt": 0})
    fits.clear()
    first_fit(made.mesh[0], made.deformation_graph, near)
    assert [values(fitting) for fitting in fits] == [values(last_steps(fit_settings(OTHERS)))]
    poses = {t: here.model_copy(update={"fitting": OTHERS}) for t, here in made.first_fit.items()}
    poses[3] = poses[3].model_copy(update={"uncovered": 0.9})
    fits.clear()
    recovery(made.deformation_graph, made.take_entries, poses, made.mesh, made.extrema)
    assert [values(fitting) for fitting in fits] == [OTHERS.model_dump()]


def values(fitting: Any) -> dict[str, Any]:
    """What parameters set of a fit."""
    return {name: getattr(fitting, name) for name in OTHERS.model_dump()}


@pytest.mark.parametrize(
    "wrong",
    [{"steps": 0}, {"stiffness": (0.0, 0.1)}, {"reach": (0.1, -0.1)}, {"scale": (0.1,)}, {"solver_steps": 0}],
)
def test_values_out_of_bounds_are_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(ValidationError):
        TrackingParams(**wrong)


def test_fits_where_a_take_is_entered_know_what_is_far_from_the_body_in_all_frames(monkeypatch: pytest.MonkeyPatch) -> None:
    made = walk()
    at = made.reference.frame + 1
    previous = made.tracking[made.reference.frame].model_copy(update={"usual": 0.05})
    places = {"rotation": np.tile(np.eye(3), (2, 1, 1)), "shift": np.zeros((2, 3)), "distance": np.zeros(2)}
    entries = TakeEntries(frames=(at,), before=(made.reference.frame,), entry=np.zeros(2, np.int32), **places)
    told: list[float] = []
    fitted = numeric_tracking.tracking

    def listening(*given: Any, distant: float = 0.0, limbs: Any = None) -> Any:
        told.append(distant)
        return fitted(*given, distant=distant, limbs=limbs)

    monkeypatch.setattr(numeric_tracking, "tracking", listening)
    tracking(made.mesh[at], made.deformation_graph, entries, previous, TrackingParams(), (at,), made.extrema[at])
    assert told == [0.05, 0.05]


def test_a_take_is_entered_facing_the_way_on_which_the_body_bends_least() -> None:
    made = walk()
    body, mesh = graph(made.deformation_graph), made.mesh[made.reference.frame + 1]
    centre = body.V.mean(axis=0)
    front, back = (
        Pose(np.tile(R, (len(body.node), 1, 1)), (body.g - centre) @ R.T + centre)
        for R in (np.eye(3), rotation((0, 0, 1), np.pi))
    )
    frame = Target.of(np.array(mesh.vertices), mesh.faces, body.size)
    right, wrong, both = (entered(body, starts, frame, FITTING) for starts in ([front], [back], [back, front]))
    apart = np.linalg.norm(shape(body, right.pose)[0] - shape(body, wrong.pose)[0], axis=1).mean()
    assert apart > 0.1 * body.size, "back to front, the left arm lies on the right one"
    assert wrong.uncovered < 0.1, "and covers the frame"
    np.testing.assert_array_equal(both.pose.translation, right.pose.translation)
