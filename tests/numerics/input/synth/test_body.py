"""Laws of synthetic 3D video: closed surfaces, constant bones, pure frames, and defects that are what was asked for."""

import hashlib
import json
import os
import subprocess
import sys
from importlib.resources import files

import numpy as np
import pytest
import trimesh
import yaml

from kinetree.errors import FigureError
from kinetree.tasks.numerics.geometry.normals import vertex_normals
from kinetree.tasks.numerics.input.synth import body as module
from kinetree.tasks.numerics.input.synth.body import Body
from kinetree.tasks.numerics.input.synth.defects import punctured
from kinetree.tasks.numerics.input.synth.figures import named
from kinetree.tasks.numerics.input.synth.implicit import values
from kinetree.tasks.numerics.input.synth.motion import true_joints

FIGURES = {
    path.name.removesuffix(".yaml"): yaml.safe_load(path.read_text("utf-8"))
    for path in files("kinetree.configs").joinpath("figures").iterdir()
}
MOTIONS = [(name, motion) for name in sorted(FIGURES) for motion in FIGURES[name]["motions"]]
HAND_ON_HIP = {"limb": "hand_r", "target": "hip_r", "begin": 12, "end": 26}


def body(name="human", **settings):
    return Body.of(named(name, FIGURES), **settings)


def mesh(V, F):
    return trimesh.Trimesh(V, F, process=False)


def boundary_loops(F):
    edges = np.sort(np.concatenate([F[:, [0, 1]], F[:, [1, 2]], F[:, [2, 0]]]), axis=1)
    unique, count = np.unique(edges, axis=0, return_counts=True)
    return len(trimesh.graph.connected_components(unique[count == 1]))


def winding(V, F, P):
    """Winding number of the mesh around points, by the solid angles of its faces (Van Oosterom and Strackee 1983)."""
    total = np.zeros(len(P))
    for i, p in enumerate(P):
        a, b, c = (V[F[:, k]] - p for k in range(3))
        la, lb, lc = (np.linalg.norm(x, axis=1) for x in (a, b, c))
        det = np.einsum("ij,ij->i", a, np.cross(b, c))
        along = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
        total[i] = np.arctan2(det, along).sum() / (2.0 * np.pi)
    return total


@pytest.mark.parametrize(("name", "motion"), MOTIONS)
def test_without_contact_every_frame_is_one_closed_sphere_of_about_the_asked_vertices(name, motion):
    clip = body(name, motion=motion, vertices=3000)
    for t in range(0, 36, 3):
        V, F = clip.frame(t)
        surface = mesh(V, F)
        assert surface.is_watertight, t
        assert surface.is_winding_consistent, t
        assert surface.volume > 0.0, t
        assert (surface.euler_number, surface.body_count) == (2, 1), t
        assert abs(len(V) / 3000 - 1.0) < 0.1, t


@pytest.mark.parametrize(("name", "motion"), MOTIONS)
def test_every_joint_that_a_motion_names_turns_enough_to_be_scored(name, motion):
    truth = body(name, motion=motion).truth()
    moved = set(FIGURES[name]["motions"][motion]) - {truth["joints"][0]["name"]}
    assert moved == {joint["name"] for joint in truth["joints"] if joint["scored"]}
    assert len(moved) >= 6


@pytest.mark.parametrize("name", sorted(FIGURES))
def test_joints_lie_inside_the_body_in_every_frame(name):
    clip = body(name)
    for x, g in zip(clip.X, clip.G, strict=True):
        assert values(clip.flesh.at(x, g), x)[0].max() < 0.0


def test_bones_keep_their_lengths_through_motion_and_contact():
    clip = body(contacts=[HAND_ON_HIP])
    child, parent = clip.flesh.child, clip.flesh.parent
    rest = np.linalg.norm(clip.figure.rest[child] - clip.figure.rest[parent], axis=1)
    posed = np.linalg.norm(clip.X[:, child] - clip.X[:, parent], axis=2)
    np.testing.assert_allclose(posed, np.broadcast_to(rest, posed.shape), rtol=1e-9)


def test_a_hand_on_the_hip_adds_a_handle_in_exactly_the_frames_of_the_truth():
    clip = body(vertices=4000, contacts=[HAND_ON_HIP])
    with_handle = []
    for t in range(36):
        surface = mesh(*clip.frame(t))
        assert surface.is_watertight, t
        assert surface.euler_number in (0, 2), t
        if surface.euler_number == 0:
            with_handle.append(t)
    assert clip.truth()["contacts"] == [{"limb": "hand_r", "target": "hip_r", "frames": with_handle}]
    assert with_handle == list(range(12, 27))


def test_far_from_its_contact_a_clip_moves_as_without_it():
    free, touching = body(), body(contacts=[HAND_ON_HIP])
    np.testing.assert_array_equal(free.X[:7], touching.X[:7])
    np.testing.assert_array_equal(free.X[32:], touching.X[32:])
    assert np.abs(free.X[19] - touching.X[19]).max() > 0.05 * free.figure.height


def test_a_frame_is_the_same_bytes_in_any_order_and_in_another_process():
    settings = {"vertices": 1500, "noise": 0.001, "holes": 2, "seed": 5}

    def digest(clip, order):
        meshes = {t: clip.frame(t) for t in order}
        return [hashlib.sha256(V.tobytes() + F.tobytes()).hexdigest() for V, F in (meshes[t] for t in sorted(meshes))]

    here = digest(body("starfish", **settings), (0, 1, 2))
    assert here == digest(body("starfish", **settings), (2, 0, 1))
    script = (
        "import hashlib, json, sys; from kinetree.tasks.numerics.input.synth.figures import Figure\n"
        "from kinetree.tasks.numerics.input.synth.body import Body\n"
        "figure, settings = json.load(sys.stdin); clip = Body.of(Figure.of(figure), **settings)\n"
        "frames = [clip.frame(t) for t in range(3)]\n"
        "print(json.dumps([hashlib.sha256(V.tobytes() + F.tobytes()).hexdigest() for V, F in frames]))"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "7", "OMP_NUM_THREADS": "2"}
    text = json.dumps([FIGURES["starfish"], settings])
    there = subprocess.run([sys.executable, "-c", script], input=text, capture_output=True, text=True, env=environment)
    assert json.loads(there.stdout) == here, there.stderr


def test_another_seed_or_frame_samples_the_same_surface_differently():
    clip, other = body("starfish", vertices=1000, seed=1), body("starfish", vertices=1000, seed=2)
    V, F = clip.frame(4)
    W, E = other.frame(4)
    assert F.shape != E.shape or not np.array_equal(F, E)
    still = body("starfish", frames=2, fps=1e9, vertices=1000)
    np.testing.assert_allclose(still.X[0], still.X[1], atol=1e-6)
    assert not np.array_equal(still.frame(0)[1], still.frame(1)[1])
    cones = clip.flesh.at(clip.X[4], clip.G[4])
    for P in (V, W):
        assert np.abs(values(cones, P)[0]).max() < 0.01 * clip.figure.height


def test_noise_moves_vertices_along_their_normals_by_the_asked_share_of_the_height():
    clean, noisy = body(vertices=3000), body(vertices=3000, noise=0.002)
    V, F = clean.frame(3)
    W, E = noisy.frame(3)
    np.testing.assert_array_equal(F, E)
    along = np.einsum("vi,vi->v", W - V, vertex_normals(V, F))
    np.testing.assert_allclose(np.abs(along), np.linalg.norm(W - V, axis=1), atol=1e-9)
    assert np.sqrt(np.mean(along**2)) == pytest.approx(0.002 * clean.figure.height, rel=1e-9)
    neighbours = np.concatenate([F[:, :2], F[:, 1:]])
    share = np.corrcoef(along[neighbours[:, 0]], along[neighbours[:, 1]])[0, 1]
    assert 0.2 < share < 0.6


def test_holes_open_the_surface_that_often_and_leave_no_loose_vertex():
    V, F = body(vertices=4000, holes=3, hole_size=0.02, seed=1).frame(2)
    assert not mesh(V, F).is_watertight
    assert boundary_loops(F) == 3
    np.testing.assert_array_equal(np.unique(F), np.arange(len(V)))


def test_a_hole_takes_the_cap_of_its_radius_off_a_ball():
    ball = trimesh.creation.icosphere(subdivisions=5)
    V, F = punctured(np.array(ball.vertices), np.array(ball.faces), 1, 0.5, np.random.default_rng(3))
    # A cap of chord r has the area πr² on every sphere.
    assert ball.area - mesh(V, F).area == pytest.approx(np.pi * 0.5**2, rel=0.12)
    assert boundary_loops(F) == 1


def test_a_dropped_limb_is_missing_in_exactly_its_frames():
    clip = body(vertices=2000, frames=12, dropped=[{"limb": "elbow_l", "begin": 3, "end": 6}])
    wrist = clip.figure.names.index("wrist_l")
    missing = []
    for t in range(12):
        V, F = clip.frame(t)
        assert mesh(V, F).is_watertight, t
        if np.linalg.norm(V - clip.X[t, wrist], axis=1).min() > 0.05 * clip.figure.height:
            missing.append(t)
    assert clip.truth()["dropped"] == [{"limb": "elbow_l", "frames": missing}]
    assert missing == [3, 4, 5, 6]


def test_the_truth_survives_json_and_says_what_was_posed():
    clip = body(frames=5)
    truth = json.loads(json.dumps(clip.truth()))
    assert truth["unit"] == "mm"
    assert truth["height"] == pytest.approx(1500.0, rel=0.01)
    np.testing.assert_array_equal(np.array(truth["positions"]), clip.X)
    assert [joint["name"] for joint in truth["joints"]] == clip.figure.names
    assert {joint["kind"] for joint in truth["joints"]} == {"joint", "tip"}
    assert truth["joints"][0]["parent"] is None


def test_a_vertex_of_a_rigid_part_keeps_its_part_and_its_distance_from_the_joint():
    clip = body(connectivity="fixed", vertices=2000)
    first, last = clip.frame(0)[0], clip.frame(9)[0]
    parts = clip.truth()["parts"]
    rigid = clip.weights().max(axis=1) > 0.999
    assert rigid.mean() > 0.3
    np.testing.assert_array_equal(clip.parts(0, first)[rigid], clip.parts(9, last)[rigid])
    owner = clip.weights().argmax(axis=1)
    spoken = np.array([clip.figure.names[j] in parts[p] for j, p in zip(owner, clip.parts(9, last), strict=True)])
    assert spoken[rigid].all()
    shins = rigid & np.isin(owner, [clip.figure.names.index("knee_l"), clip.figure.names.index("knee_r")])
    for t, V in ((0, first), (9, last)):
        local = np.einsum("vji,vj->vi", clip.G[t][owner], V - clip.X[t][owner])
        rest = clip.skin.V - clip.figure.rest[owner]
        assert np.abs(local - rest)[shins].max() < 0.01 * clip.figure.height


def test_a_volume_is_negative_exactly_inside_the_mesh():
    clip = body(vertices=4000, contacts=[HAND_ON_HIP])
    volume = clip.volume(15, voxel=30.0)
    index = np.argwhere(np.abs(volume.field) > 6.0)
    index = index[np.random.default_rng(0).permutation(len(index))[:600]]
    deep = np.argwhere(volume.field < -6.0)
    index = np.concatenate([index, deep[:: max(1, len(deep) // 200)]])
    around = winding(*clip.frame(15), volume.origin + volume.voxel * index)
    np.testing.assert_array_equal(volume.field[tuple(index.T)] < 0.0, around > 0.5)
    assert 100 < (around > 0.5).sum() < len(index)


def test_volumes_of_a_clip_share_their_grid():
    clip = body("starfish")
    first, later = clip.volume(0), clip.volume(20)
    assert first.field.shape == later.field.shape
    np.testing.assert_array_equal(first.origin, later.origin)
    for field in (first.field, later.field):
        shell = np.concatenate([field[[0, -1]].ravel(), field[:, [0, -1]].ravel(), field[:, :, [0, -1]].ravel()])
        assert shell.min() > 0.0


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"frames": 0}, "frames is 0, expected a whole number of at least 1"),
        ({"frames": 10**11}, "frames is 100000000000, expected at most 1000000"),
        ({"holes": 10**5}, ", a tenth of the vertices"),
        ({"vertices": 7}, "vertices is 7"),
        ({"noise": -0.1}, "noise is -0.1, expected a share"),
        ({"holes": -1}, "holes is -1"),
        ({"fps": 0}, "fps is 0"),
        ({"connectivity": "fixd"}, "did you mean 'fixed'"),
        ({"connectivity": "fixed", "holes": 1}, "neither holes nor dropped limbs"),
        ({"motion": "wlak"}, "did you mean 'walk'"),
        ({"dropped": [{"limb": "elbow_k", "begin": 0, "end": 1}]}, "did you mean 'elbow_"),
        ({"dropped": [{"limb": "hand_l", "begin": 0, "end": 1}]}, "lies no limb"),
        ({"dropped": [{"limb": "hips", "begin": 0, "end": 1}]}, "lies the whole figure"),
        ({"dropped": [{"limb": "elbow_l", "begin": 2, "end": 36}]}, "0 ≤ begin ≤ end < 36"),
        ({"dropped": [{"limb": "elbow_l"}]}, "expected exactly limb, begin and end"),
    ],
)
def test_a_clip_that_cannot_be_is_refused_in_words(settings, words):
    with pytest.raises(FigureError) as refusal:
        body(**settings)
    assert words in str(refusal.value)


def test_a_frame_or_voxel_that_cannot_be_is_refused_in_words():
    clip = body(frames=3)
    with pytest.raises(FigureError, match="frame 3 was asked for, but the clip has frames 0 to 2"):
        clip.frame(3)
    with pytest.raises(FigureError, match="voxel is 0, expected a length above 0"):
        clip.volume(0, voxel=0)


def test_an_unknown_figure_is_refused_with_the_nearest_name():
    with pytest.raises(FigureError, match="did you mean 'human'"):
        named("hunam", FIGURES)


def test_turning_of_joints_is_measured_once_for_all_frames(monkeypatch):
    """It compares every frame with every other, so that asking in every frame would take the cube of their number."""
    measured = []

    def counted(figure, R):
        measured.append(len(R))
        return true_joints(figure, R)

    monkeypatch.setattr(module, "true_joints", counted)
    generated = body(frames=6)
    V = generated.X[0]
    for t in range(6):
        generated.parts(t, V)
    assert generated.truth() == generated.truth()
    assert measured == [6]


def test_truth_that_somebody_changes_stays_what_it_was():
    generated = body(frames=3)
    truth = generated.truth()
    truth["joints"][0]["name"] = "changed"
    truth["parts"][0].append("changed")
    assert "changed" not in str(generated.truth())


@pytest.mark.parametrize("joint", ["head_top", "hand_l", "toe_l"])
def test_head_hands_and_feet_of_the_adult_show_how_they_turn(joint):
    def roundness(name):
        clip = body(name, vertices=6000, frames=1)
        figure = clip.figure
        at = figure.names.index(joint)
        base = figure.parents[at]
        V, _ = clip.frame(0)
        axis = clip.X[0, at] - clip.X[0, base]
        length = np.linalg.norm(axis)
        along = (V - clip.X[0, base]) @ axis / length
        across = V - clip.X[0, base] - along[:, None] * axis / length
        wide = 1.5 * max(length, max(figure.joints[at].radii))
        near = (along > 0.2 * length) & (along < 0.8 * length) & (np.linalg.norm(across, axis=1) < wide)
        spread = np.linalg.eigvalsh(across[near].T @ across[near])
        return np.sqrt(spread[1] / spread[2])

    assert roundness("adult") < 0.85
    assert joint != "head_top" or roundness("human") > 0.85
