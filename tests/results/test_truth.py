"""Where a truth comes from, and that it is asked for before anything runs."""

import json
from pathlib import Path

import numpy as np
import pytest
from results.true_skeletons import generated, observed, written_truth

from kinetree.errors import InputError
from kinetree.schemas.input.source import Source
from kinetree.schemas.results.truth import Truth, TruthParams
from kinetree.tasks.input.synth import body
from kinetree.tasks.numerics.input import unpacked
from kinetree.tasks.results.truth import synthetic, true_carriers, truth

RECIPE = generated(frames=3, vertices=300)


def read(**params: object) -> Truth:
    return truth.function(params=TruthParams.model_validate(params), files=None)


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "truth.json"
    path.write_text(written_truth(RECIPE))
    return path


def test_no_file_is_no_truth() -> None:
    true = read()
    assert (true.names, true.frames, true.source) == ((), (), "")


def test_file_and_recipe_of_the_same_body_say_the_same(file: Path) -> None:
    true = read(file=str(file))
    assert true.source == "truth.json"
    assert true.model_copy(update={"source": "synth"}) == synthetic(RECIPE)


def test_user_says_with_which_frame_a_truth_without_numbers_begins(file: Path) -> None:
    assert (read(file=str(file)).frames, read(file=str(file)).numbered) == ((0, 1, 2), False)
    assert (read(file=str(file), first=4).frames, read(file=str(file), first=4).numbered) == ((4, 5, 6), True)
    true = json.loads(file.read_text())
    file.write_text(json.dumps({**true, "frames": [1, 2, 5]}))
    assert (read(file=str(file), first=4).frames, read(file=str(file)).numbered) == ((1, 2, 5), True)


def test_file_that_changed_is_read_again(file: Path) -> None:
    before = read(file=str(file))
    true = json.loads(file.read_text())
    true["positions"][0][0][0] += 1.0
    file.write_text(json.dumps(true, indent=1))
    assert read(file=str(file)).positions[0, 0, 0] == before.positions[0, 0, 0] + 1.0


def test_unit_that_the_user_says_stands_in_for_one_the_file_does_not_say(file: Path) -> None:
    true = json.loads(file.read_text())
    assert read(file=str(file), unit="cm").unit == "mm"
    file.write_text(json.dumps({**true, "unit": "unknown"}))
    assert read(file=str(file), unit="cm").unit == "cm"


def test_body_of_a_generated_sequence_tells_what_carries_each_vertex() -> None:
    source, mesh, _ = observed(RECIPE)
    carriers = true_carriers(synthetic(RECIPE), source[1], mesh[1].vertices, 1, "mm")
    assert carriers is not None
    most = body(RECIPE).weights().argmax(axis=1)
    assert (carriers[0] == most).mean() > 0.7  # the nearest limb and the heaviest weight differ where limbs blend
    assert true_carriers(synthetic(RECIPE), Source(content="", path=""), mesh[1].vertices, 1, "mm") is None


def test_true_body_tells_what_carries_the_nearest_vertex(file: Path, tmp_path: Path) -> None:
    generated = body(RECIPE)
    V = np.concatenate([generated.frame(t)[0] for t in range(3)])
    npz = tmp_path / "body.npz"
    np.savez(npz, vertices=V.astype(np.float32), weights=generated.weights(), weight_names=generated.figure.names)
    true = read(file=str(file), body=str(npz))
    carriers = true_carriers(true, Source(content="", path=""), generated.frame(2)[0] / 1000 + 1e-7, 2, "m")
    assert carriers is not None
    assert np.array_equal(carriers[0], generated.weights().argmax(axis=1))
    assert (carriers[1] == -1).all()


def test_weights_of_bones_are_named_by_the_numbers_of_both_joints(file: Path, tmp_path: Path) -> None:
    generated, true = body(RECIPE), synthetic(RECIPE)
    child = next(j for j, p in enumerate(true.parents) if p == 1)
    npz = tmp_path / "body.npz"
    V = np.concatenate([generated.frame(t)[0] for t in range(3)])
    arrays = {"vertices": V.astype(np.float32), "weights": np.ones((len(V) // 3, 1))}
    np.savez(npz, **arrays, weight_names=[f"bone_1_{child}"])
    read_back = read(file=str(file), body=str(npz))
    assert set(read_back.carrier.tolist()) == {1}
    assert set(read_back.bone_end.tolist()) == {child}
    np.savez(npz, **arrays, weight_names=[f"bone_0_{child}"])
    with pytest.raises(InputError, match="are none of them"):
        read(file=str(file), body=str(npz))


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"vertices": np.zeros((4, 3))}, "not a body: .*weights.*; expected an npz"),
        ({"vertices": np.zeros((4, 3)), "weights": np.ones((4, 1)), "weight_names": ["hip"]}, r"\['hip'\] are none of them"),
        ({"vertices": np.zeros((4, 3)), "weights": np.ones((4, 1)), "weight_names": None}, "4 vertices are not 3 frames of 4"),
        ({"vertices": np.zeros(12), "weights": np.ones((4, 1)), "weight_names": None}, r"must be \(frame · vertex, 3\)"),
        ({"vertices": np.full((12, 3), np.nan), "weights": np.ones((4, 1)), "weight_names": None}, "all numbers finite"),
        ({"vertices": np.array(["a"]), "weights": np.ones((4, 1)), "weight_names": None}, "not a body: could not convert"),
    ],
)
def test_body_that_does_not_fit_is_refused(file: Path, tmp_path: Path, arrays: dict[str, object], message: str) -> None:
    if arrays.get("weight_names", ()) is None:
        arrays = {**arrays, "weight_names": [synthetic(RECIPE).names[0]]}
    npz = tmp_path / "body.npz"
    np.savez(npz, **arrays)
    with pytest.raises(InputError, match=message):
        read(file=str(file), body=str(npz))


def test_body_that_would_unpack_to_too_much_is_refused_unread(
    file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    npz = tmp_path / "body.npz"
    np.savez_compressed(npz, vertices=np.zeros((10**4, 3)), weights=np.ones((4, 1)), weight_names=synthetic(RECIPE).names[:1])
    monkeypatch.setattr(unpacked, "UNPACKED_BYTES", 10**5)
    with pytest.raises(InputError, match=r"body\.npz: vertices: \d+ bytes would unpack to 240128; expected at most 100 times"):
        read(file=str(file), body=str(npz))


def test_what_cannot_be_read_is_refused_in_words(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"nowhere\.json: cannot be read: No such file"):
        read(file=str(tmp_path / "nowhere.json"))
    with pytest.raises(InputError, match="cannot be read: Is a directory"):
        read(file=str(tmp_path))
    (tmp_path / "a.bvh").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(InputError, match="not a text file"):
        read(file=str(tmp_path / "a.bvh"))
    with pytest.raises(InputError, match=r"needs truth\.file"):
        read(body=str(tmp_path / "body.npz"))
    (tmp_path / "b.json").write_text("{}")
    (tmp_path / "no.npz").write_text("no")
    (tmp_path / "t.json").write_text(written_truth(RECIPE))
    with pytest.raises(InputError, match="not a body"):
        read(file=str(tmp_path / "t.json"), body=str(tmp_path / "no.npz"))
