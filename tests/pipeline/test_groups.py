"""What of a user's zarr group is read, and what is refused before a byte of it is decoded."""

import json
import pickle
import subprocess
import sys
import zlib
from pathlib import Path

import numpy as np
import pytest
import zarr
from zarr.codecs import BloscCodec, Crc32cCodec, GzipCodec, ShardingCodec, ZstdCodec

from kinetree.errors import StoreError
from kinetree.pipeline.storage import groups
from kinetree.pipeline.storage.groups import ForeignArrayError, decoded, group_files, user_arrays
from kinetree.schemas.dims import Dim

NAMES = ("vertices", "fps", "unit")


def test_named_arrays_and_attributes_of_any_group_are_read(tmp_path):
    group = zarr.create_group(tmp_path / "g", attributes={"fps": 25, "unit": "mm", "more": {"a": 1}})
    group.create_array("vertices", data=np.arange(6.0).reshape(2, 3))
    group.create_array("colours", data=np.arange(6.0))
    arrays = user_arrays(tmp_path / "g", NAMES)
    np.testing.assert_array_equal(arrays["vertices"], np.arange(6.0).reshape(2, 3))
    assert (arrays["fps"].item(), arrays["unit"].item()) == (25, "mm")
    assert set(arrays) == set(NAMES)


@pytest.mark.parametrize("compressors", [None, ZstdCodec(level=3), GzipCodec(), BloscCodec(), [ZstdCodec(), Crc32cCodec()]])
@pytest.mark.parametrize("dtype", ["float32", "float64", "int32", "uint8"])
def test_arrays_in_the_usual_codecs_are_read(tmp_path, compressors, dtype):
    data = np.arange(600).reshape(200, 3).astype(dtype)
    zarr.create_group(tmp_path / "g").create_array("vertices", data=data, chunks=(64, 3), compressors=compressors)
    np.testing.assert_array_equal(user_arrays(tmp_path / "g", NAMES)["vertices"], data)


def test_folder_that_is_no_group_is_refused_by_name(tmp_path):
    (tmp_path / "zarr.json").write_text("hello")
    with pytest.raises(StoreError, match="not a readable zarr group: its metadata cannot be read"):
        user_arrays(tmp_path, NAMES)


def test_group_of_format_2_is_refused_with_what_to_do(tmp_path):
    zarr.create_group(tmp_path / "g", zarr_format=2).create_array("vertices", data=np.zeros((4, 3)))
    with pytest.raises(StoreError, match=r"it is of zarr format 2; write it again in format 3 \(zarr_format=3\)"):
        user_arrays(tmp_path / "g", NAMES)


class Bomb:
    """Leaves a file where it is unpickled."""

    def __init__(self, path):
        self.path = path

    def __reduce__(self):
        return (Path.touch, (self.path,))


@pytest.mark.parametrize("outer", [2, 3])
@pytest.mark.parametrize("codecs", [{"filters": [{"id": "pickle"}]}, {"compressor": {"id": "pickle"}}])
def test_nothing_in_a_users_zarr_is_unpickled(tmp_path, outer, codecs):
    group = tmp_path / "g"
    (group / "vertices").mkdir(parents=True)
    if outer == 2:
        (group / ".zgroup").write_text('{"zarr_format": 2}')
    else:
        (group / "zarr.json").write_text('{"zarr_format": 3, "node_type": "group"}')
    metadata = {"zarr_format": 2, "shape": [1], "chunks": [1], "dtype": "|O", "compressor": None, "filters": None, "order": "C"}
    (group / "vertices" / ".zarray").write_text(json.dumps({**metadata, "fill_value": None, **codecs}))
    (group / "vertices" / "0").write_bytes(pickle.dumps(Bomb(tmp_path / "exploded")))
    with pytest.raises(StoreError, match="not a readable zarr group"):
        user_arrays(group, NAMES)
    assert not (tmp_path / "exploded").exists()


def altered(tmp_path, **changes):
    """A good array whose metadata was then changed."""
    zarr.create_group(tmp_path / "g").create_array("vertices", data=np.ones((4, 3)), compressors=ZstdCodec())
    path = tmp_path / "g" / "vertices" / "zarr.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), **changes}))
    return tmp_path / "g"


BYTES = {"name": "bytes", "configuration": {"endian": "little"}}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"codecs": [BYTES, {"name": "numcodecs.pickle", "configuration": {}}]}, "codecs bytes, numcodecs.pickle"),
        ({"codecs": [{"name": "vlen-utf8"}], "data_type": "string"}, "data type 'string'"),
        ({"data_type": "object"}, "data type 'object'"),
        ({"data_type": {"name": "struct", "configuration": {"fields": []}}}, "data type"),
        ({"codecs": [BYTES, {"name": "zstd"}, {"name": "gzip"}]}, "at most is read"),
        ({"storage_transformers": [{"name": "x"}]}, "codecs"),
        ({"shape": [4, -3]}, "its shape or chunks cannot be read"),
        ({"shape": [10**12, 3]}, "would unpack to"),
        ({"chunk_grid": {"name": "regular", "configuration": {"chunk_shape": [10**9, 3]}}}, "chunks of"),
        ({"chunk_grid": {"name": "rectilinear"}}, "regular grid"),
        ({"zarr_format": 4}, "format 4"),
    ],
)
def test_what_is_not_on_the_list_is_refused_by_its_name(tmp_path, changes, words):
    with pytest.raises(StoreError) as refused:
        user_arrays(altered(tmp_path, **changes), NAMES)
    assert words in str(refused.value)


def test_shards_are_refused(tmp_path):
    codec = ShardingCodec(chunk_shape=(2, 3))
    zarr.create_group(tmp_path / "g").create_array("vertices", data=np.ones((4, 3)), serializer=codec, compressors=None)
    with pytest.raises(StoreError, match="without shards"):
        user_arrays(tmp_path / "g", NAMES)


def zstd_frame(size):
    """The head of a zstd frame that says it holds `size` bytes, all zero, and one block of it."""
    return b"\x28\xb5\x2f\xfd" + bytes([0xE0]) + size.to_bytes(8, "little") + b"\x03\x00\x10\x00"


@pytest.mark.parametrize("chunk", [zstd_frame(24 * 10**9), b"\x28\xb5\x2f\xfd\x00\x58" + b"\x02\x00\x10\x00" * 4])
def test_chunk_that_says_it_is_larger_than_its_array_is_refused(tmp_path, chunk):
    group = altered(tmp_path)
    (group / "vertices" / "c" / "0" / "0").write_bytes(chunk)
    with pytest.raises(StoreError, match="a chunk would unpack to"):
        user_arrays(group, NAMES)


@pytest.mark.parametrize(("codec", "chunk"), [
    ("gzip", zlib.compress(bytes(10**6), wbits=31)),
    ("gzip", zlib.compress(bytes(96), wbits=31) * 9),
    ("blosc", b"\x02\x01\x21\x08" + (10**9).to_bytes(4, "little") + bytes(24)),
    (None, bytes(10**4)),
])  # fmt: skip
def test_chunk_that_unpacks_to_more_than_its_array_is_refused(tmp_path, codec, chunk):
    blosc = {"cname": "lz4", "clevel": 5, "shuffle": "shuffle", "typesize": 8, "blocksize": 0}
    options = {"gzip": {"level": 5}, "blosc": blosc}
    group = altered(tmp_path, codecs=[BYTES, *([{"name": codec, "configuration": options[codec]}] if codec else [])])
    (group / "vertices" / "c" / "0" / "0").write_bytes(chunk)
    with pytest.raises(StoreError, match="a chunk would unpack to"):
        user_arrays(group, NAMES)


READ = """
import resource, sys
from pathlib import Path
from kinetree.errors import InputError
from kinetree.pipeline.storage.groups import user_arrays
from kinetree.tasks.numerics.input.source import ARRAYS, Frames, read_npz
path = Path(sys.argv[1])
import zarr, numpy  # what importing takes is no part of it
before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
try:
    frames = read_npz(path) if path.suffix == ".npz" else Frames.of(user_arrays(path, ARRAYS), str(path))
    print(len(frames), "frames")
except InputError as error:
    print(error)
print((resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) // 1024)
"""


def reading(path):
    """What a process of its own says of an input, and how many MiB it took at its peak."""
    done = subprocess.run([sys.executable, "-c", READ, str(path)], capture_output=True, text=True, check=True)
    words, mebibytes = done.stdout.strip().splitlines()
    return words, int(mebibytes)


def write_sequence(path):
    group = zarr.create_group(path)
    group.create_array("vertices", data=np.random.default_rng(0).normal(size=(8, 3)))
    group.create_array("faces", data=np.array([[0, 1, 2], [1, 2, 3]], dtype="int32"))
    group.create_array("vertex_offsets", data=np.array([0, 4, 8]))
    group.create_array("face_offsets", data=np.array([0, 2]))
    return group


def test_array_that_nobody_asked_for_takes_no_memory(tmp_path):
    group = write_sequence(tmp_path / "a.zarr")
    group.create_array("colours", shape=(3 * 10**9,), dtype="float64", chunks=(10**6,))
    words, mebibytes = reading(tmp_path / "a.zarr")
    assert words == "2 frames"
    assert mebibytes < 100


def test_array_of_much_memory_of_which_little_is_stored_is_refused_before_it_is_taken(tmp_path):
    group = write_sequence(tmp_path / "a.zarr")
    del group["vertices"]
    group.create_array("vertices", shape=(10**9, 3), dtype="float64", chunks=(10**6, 3))
    words, mebibytes = reading(tmp_path / "a.zarr")
    assert "vertices: not a readable zarr array: 0 bytes would unpack to 24000000000" in words
    assert mebibytes < 100


def test_archive_that_unpacks_to_much_more_is_refused_before_memory_is_taken(tmp_path):
    np.savez_compressed(tmp_path / "a.npz", vertices=np.zeros((2 * 10**7, 3)), faces=np.zeros((4, 3), dtype="int32"))
    message, mebibytes = reading(tmp_path / "a.npz")
    assert "vertices: " in message
    assert "bytes would unpack to 480000128; expected at most 100 times as many" in message
    assert mebibytes < 100


def test_stored_group_with_a_codec_that_is_not_ours_is_not_decoded():
    class Spec:
        dtype, unit, dims = "float64", "1", ()

    files = group_files({}, {"x": np.array(0.5)}, {"x": Spec})
    own = {path.removeprefix("x/"): data for path, data in files.items() if path.startswith("x/")}
    assert decoded(own, Spec) == 0.5
    own["zarr.json"] = own["zarr.json"].replace(b'"zstd"', b'"evil"')
    with pytest.raises(ForeignArrayError, match="codecs bytes, evil"):
        decoded(own, Spec)


class Numbers:
    """What a schema would say of an array of any dtype and rank."""

    def __init__(self, array):
        self.dtype, self.unit, self.dims = str(array.dtype), "1", tuple(Dim(f"d{n}") for n in range(array.ndim))


def own_files(array):
    """The files of one array, as `group_files` writes them."""
    files = group_files({}, {"x": array}, {"x": Numbers(array)})
    return {path.removeprefix("x/"): data for path, data in files.items() if path.startswith("x/")}


@pytest.mark.parametrize("shape", [(), (1,), (7,), (4, 3), (2, 3, 4), (0, 3)])
@pytest.mark.parametrize("dtype", ["bool", "uint8", "int32", "float32", "float64"])
def test_array_of_one_chunk_is_unpacked_as_zarr_unpacks_it_and_without_zarr(monkeypatch, shape, dtype):
    array = np.random.default_rng(0).integers(0, 2, shape).astype(dtype)
    files = own_files(array)
    by_zarr = groups._read(files)
    monkeypatch.delattr(groups, "_read")
    found = decoded(files, Numbers(array))
    assert (found.dtype, found.shape, found.tobytes()) == (by_zarr.dtype, by_zarr.shape, by_zarr.tobytes())


def test_array_of_many_chunks_is_read_by_zarr(monkeypatch):
    monkeypatch.setattr(groups, "CHUNK_BYTES", 64)
    array = np.arange(60.0).reshape(20, 3)
    files = own_files(array)
    assert len(files) > 2
    np.testing.assert_array_equal(decoded(files, Numbers(array)), array)


def test_big_endian_chunk_is_read_as_what_it_is():
    array = np.arange(6.0)
    files = own_files(array)
    files["zarr.json"] = files["zarr.json"].replace(b'"little"', b'"big"')
    np.testing.assert_array_equal(decoded(files, Numbers(array)), array.astype("<f8").view(">f8"))


@pytest.mark.parametrize("length", [5, 7])
def test_chunk_of_another_size_than_its_array_is_refused(length):
    files = own_files(np.arange(6.0))
    files["c/0"] = own_files(np.arange(float(length)))["c/0"]
    with pytest.raises(ForeignArrayError, match=f"a chunk holds {8 * length} bytes, expected 48"):
        decoded(files, None)


def test_limits_are_those_of_the_documentation():
    assert (groups.UNPACKED_BYTES, groups.UNPACKED_RATIO) == (256 * 2**20, 100)
