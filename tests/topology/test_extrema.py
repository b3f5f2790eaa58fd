"""The tips of one frame, as the task gives them."""

import numpy as np
import pytest
import trimesh

from kinetree.schemas.input.mesh import Cleaning, Mesh
from kinetree.schemas.input.synth import SynthParams
from kinetree.schemas.topology.extrema import Extrema, ExtremaParams
from kinetree.schemas.topology.geodesics import GeodesicsParams
from kinetree.tasks.input.synth import body, recipe
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics


def mesh(V: np.ndarray, F: np.ndarray) -> Mesh:
    return Mesh(vertices=V, faces=F.astype(np.int32), vertex_of_input=np.arange(len(V)), cleaning=Cleaning())


def tips_of(frame: Mesh) -> Extrema:
    return extrema(frame, geodesics(frame, GeodesicsParams(bases=60)), ExtremaParams())


@pytest.mark.parametrize(
    ("figure", "names"),
    [
        ("human", {"head_top", "hand_l", "hand_r", "toe_l", "toe_r"}),
        ("starfish", {f"end_{n}" for n in range(1, 6)}),
    ],
)
def test_tips_are_the_ends_of_the_limbs_and_nothing_else(figure: str, names: set[str]) -> None:
    generated = body(recipe(SynthParams(figure=figure, vertices=2000)))
    tips = tips_of(mesh(*generated.frame(0)))
    ends = [n for n, joint in enumerate(generated.truth()["joints"]) if joint["kind"] == "tip"]
    away = np.linalg.norm(tips.stems[:, -1][:, None] - generated.X[0][ends][None], axis=2)
    nearest = {generated.figure.names[ends[n]] for n in away.argmin(axis=1)}
    assert {name.replace("heel", "toe") for name in nearest} == names
    assert len(tips.vertices) == len(names)
    assert away.min(axis=1).max() < 0.1 * generated.figure.height


def test_ball_has_no_tips_and_says_so_with_empty_arrays() -> None:
    ball = trimesh.creation.icosphere(subdivisions=3)
    tips = tips_of(mesh(np.array(ball.vertices), np.array(ball.faces)))
    assert len(tips.vertices) == len(tips.peaks) == len(tips.loops) == 0
    assert tips.size == pytest.approx(np.sqrt(ball.area))


def test_normals_point_out_of_the_body() -> None:
    generated = body(recipe(SynthParams(figure="human", vertices=2000)))
    frame = mesh(*generated.frame(0))
    tips = tips_of(frame)
    limb = tips.stems[:, -1] - tips.stems[:, -2]
    assert (np.einsum("lx,lx->l", tips.normals, limb) > 0).all()
    assert np.linalg.norm(tips.normals, axis=1) == pytest.approx(np.ones(len(limb)))
