"""Laws of configuration: who wins, what is refused and in which words, and that a run's own file says the same again."""

import os
import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from kinetree.errors import ConfigError
from kinetree.pipeline.inspect import Pipeline
from kinetree.pipeline.output.output import as_yaml
from kinetree.pipeline.settings.blocks import Reading
from kinetree.pipeline.settings.config import Compute, load, with_compute
from kinetree.pipeline.settings.yaml_text import parsed
from kinetree.pipeline.storage.store import Store
from kinetree.tasks.application import APPLICATION

PRESETS = Reading.of({}, APPLICATION.presets).preset_names


def of(target=None, *sets):
    return load(target, APPLICATION, sets)


def refusal(target=None, *sets):
    with pytest.raises(ConfigError) as refused:
        of(target, *sets)
    return str(refused.value)


@pytest.fixture
def write(tmp_path):
    def to(name, text):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    return to


# ── who wins ────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_nothing_is_the_defaults_of_the_schemas(monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    config = of()
    assert config.method == "mesoscopic"
    assert all(params == type(params)() for params in config.params.values())
    assert (config.output, config.store) == (tmp_path / "kinetree-output", tmp_path / "kinetree-output" / "store")
    assert config.compute == Compute()


def test_set_goes_before_the_file_before_what_it_extends_before_the_default(write):
    write("base.yaml", "mesh: {component_share: 0.2, merge: 0.01}\nsequence: {fps: 10, unit: m}\n")
    path = write("walk.yaml", "extends: base.yaml\nmesh: {component_share: 0.3}\nsequence: {fps: 20}\n")
    config = of(path, "sequence.fps=30")
    assert (config.params["sequence"].fps, config.params["sequence"].unit) == (30, "m")
    assert (config.params["mesh"].component_share, config.params["mesh"].merge) == (0.3, 0.01)
    assert of(write("empty.yaml", "")).params["mesh"].component_share == 0.05


def test_last_set_wins():
    assert of(None, "mesh.component_share=0.1", "mesh.component_share=0.2").params["mesh"].component_share == 0.2


def test_chain_of_files_is_followed_to_its_end(write):
    write("a.yaml", "sequence: {fps: 1, unit: cm}\nmesh: {merge: 0.01}")
    write("sub/b.yaml", "extends: ../a.yaml\nsequence: {fps: 2}")
    config = of(write("c.yaml", "extends: sub/b.yaml\nmesh: {component_share: 0.5}"))
    assert config.params["sequence"].model_dump() == {"fps": 2.0, "unit": "cm", "learn_from": ":"}
    assert config.params["mesh"].model_dump() == {"merge": 0.01, "component_share": 0.5}


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_loads_by_its_name_and_can_be_extended(name, write):
    assert of(write("mine.yaml", f"extends: {name}\n")).params == of(name).params


def test_mapping_is_as_good_as_a_file():
    assert of({"sequence": {"fps": 7}}).params["sequence"].fps == 7


def test_empty_block_is_no_block(write):
    assert of(write("a.yaml", "mesh:\nsource: {}\ncompute:\noutput:\n")).params == of().params


# ── paths ───────────────────────────────────────────────────────────────────────────────────────────────────────────


def test_paths_are_relative_to_the_file_that_names_them(write, tmp_path, monkeypatch):
    monkeypatch.chdir("/")
    write("far/base.yaml", "source: {input: scans}\nstore: shared\n")
    config = of(write("near/walk.yaml", "extends: ../far/base.yaml\noutput: out\n"), "source.frames=1:3")
    assert config.params["source"].input == str(tmp_path / "far" / "scans")
    assert config.store == tmp_path / "far" / "shared"
    assert config.output == tmp_path / "near" / "out"


def test_paths_in_sets_are_relative_to_here(write, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    config = of(write("near/walk.yaml", "source: {input: scans}\n"), "output=out", "source.input=other")
    assert (config.output, config.params["source"].input) == (tmp_path / "out", str(tmp_path / "other"))


def test_tilde_is_the_users_home_and_an_unknown_one_a_name(write, tmp_path, monkeypatch):
    monkeypatch.setenv("HOME", "/home/me")
    config = of(write("a.yaml", "output: ~/out\nstore: ~nobody-of-this-name/x\nsource: {input: ~/scans}\n"))
    assert str(config.output) == "/home/me/out"
    assert config.store == tmp_path / "~nobody-of-this-name/x"
    assert config.params["source"].input == "/home/me/scans"


def test_store_may_be_in_a_bucket_and_is_saved_as_its_address(write):
    config = of(write("near/walk.yaml", "store: s3://bucket/deep\n"))
    assert config.store == config.saved()["store"] == config.portable()["store"] == "s3://bucket/deep"


# ── refusals ────────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("msh: {}", "no such key 'msh'; did you mean 'mesh'?"),
        ("stoer: x", "no such key 'stoer'; did you mean 'store'?"),
        ("1: x", "no such key 1; there are: "),
        ("? ~\n: x", "no such key None; there are: "),
        ("mesh: {component_shar: 0.1}", "mesh.component_shar: no such key; did you mean 'component_share'?"),
        ("mesh: {zzz: 0.1}", "mesh.zzz: no such key; there are: component_share, merge"),
        ("mesh: {component_share: much}", "mesh.component_share: input should be a valid number, "),
        ("mesh: {component_share: 2}", "mesh.component_share: input should be less than or equal to 1, got 2"),
        ("mesh: {component_share: .nan}", "mesh.component_share: input should be a finite number, got nan"),
        ("sequence: {fps: -5}", "sequence.fps: input should be greater than 0, got -5"),
        ("sequence: {fps: .inf}", "sequence.fps: input should be a finite number, got inf"),
        ("mesh: 0.1", "mesh: expected keys with values, got 0.1"),
        ("mesh: [merge]", "mesh: expected keys with values, got ['merge']"),
        ("mesh: false", "mesh: expected keys with values, got False"),
        ("compute: []", "compute: expected keys with values, got []"),
        ("compute: {workers: 0}", "compute.workers: input should be greater than or equal to 1, got 0"),
        ("compute: {worker: 2}", "compute.worker: no such key; did you mean 'workers'?"),
        ("method: rebe", "method 'rebe': no such method; did you mean 'reeb'?"),
        ("method: voxels", "method 'voxels': no such method; there are: mesoscopic"),
        ("method: mesoscopc", "method 'mesoscopc': no such method; did you mean 'mesoscopic'?"),
        ("method: [a]", "method ['a']: no such method; there are: "),
        ("method: {a: b}", "method {'a': 'b'}: no such method; there are: "),
        ("output: 5", "output: expected the path of a folder, got 5; put it in quotes if it is one"),
        ("store: [a]", "store: expected the path of a folder, got ['a']"),
        ("output: ''", "output: expected the path of a folder, got ''"),
        ("store: gs://bucket/x", "store: gs://bucket/x is the address of a service, which is not supported; give a folder"),
    ],
)  # fmt: skip
def test_wrong_key_or_value_is_refused_with_file_key_and_what_was_expected(write, text, words):
    path = write("walk.yaml", text)
    message = refusal(path)
    assert message.startswith(f"{path}: {words}")


def test_wrong_key_within_a_key_is_refused_with_the_nearest_there(write):
    path = write("walk.yaml", "source: {synth: {frmes: 3}}")
    assert refusal(path) == f"{path}: source.synth.frmes: no such key; did you mean 'frames'?"


@pytest.mark.parametrize("value", [False, "true", "false"])
def test_encryption_may_be_required_and_not_forgone(value):
    security = {"require_encryption": value}
    words = "config: compute.security: require_encryption: what it sets up is always encrypted; expected true or nothing"
    assert refusal({"compute": {"security": security}}) == f"{words}, got {security}"
    assert of({"compute": {"security": {"require_encryption": True}}}).compute.security == {"require_encryption": True}


def test_file_of_a_certificate_is_named_by_a_text():
    words = "config: compute.security: tls_ca_file: expected a text, got {'tls_ca_file': True}"
    assert refusal({"compute": {"security": {"tls_ca_file": True}}}) == words


@pytest.mark.parametrize("memory", ["lots", "4", "4 gb", "-1GB", ""])
def test_memory_that_is_no_size_is_refused(memory):
    words = f"config: compute.memory: expected a size such as 4GB or 512MiB, got {memory!r}"
    assert refusal({"compute": {"memory": memory}}) == words


def test_every_wrong_key_is_told_at_once(write):
    message = refusal(write("walk.yaml", "mesh: {mrge: 1, component_share: none of it}\n"))
    assert message.count("\n") == 1
    assert "mesh.mrge: no such key; did you mean 'merge'?" in message
    assert "mesh.component_share: " in message


@pytest.mark.parametrize(
    ("text", "line", "words"),
    [
        ("mesh:\n  merge: [1\nsequence: {}\n", 3, "expected ',' or ']'"),
        ("a: 1\n\tb: 2", 2, "cannot start any token"),
        ("mesh: {}\nmesh: {}\n", 2, "key 'mesh' is there twice"),
        ("mesh:\n  merge: 0\n  merge: 1\n", 3, "key 'merge' is there twice"),
        ("mesh: *nothing\n", 1, "found undefined alias"),
        ("mesh: {[1]: 2}\n", 1, "found unhashable key"),
        ("ok: 1\nmesh: !!python/object/apply:os.system ['touch exploded']\n", 2, "could not determine a constructor"),
        ("mesh: !!python/name:os.system\n", 1, "could not determine a constructor"),
    ],
)
def test_yaml_that_is_none_is_refused_with_its_line(write, tmp_path, monkeypatch, text, line, words):
    monkeypatch.chdir(tmp_path)
    path = write("walk.yaml", text)
    message = refusal(path)
    assert message.startswith(f"{path}, line {line}: not valid YAML: ")
    assert words in message
    assert [p.name for p in tmp_path.iterdir()] == ["walk.yaml"]


@pytest.mark.parametrize("text", ["- mesh", "hello", "3", "'mesh: 1'"])
def test_yaml_without_keys_is_refused(write, text):
    path = write("walk.yaml", text)
    assert refusal(path).startswith(f"{path}: expected keys with values at the top, got ")


def test_bytes_that_are_no_text_are_refused(tmp_path):
    (tmp_path / "a.yaml").write_bytes(b"\xff\xfe\x00mesh")
    assert refusal(tmp_path / "a.yaml").startswith(f"{tmp_path / 'a.yaml'}: not a text file in UTF-8: byte 0 is 0xff")
    (tmp_path / "b.yaml").write_bytes(b"mesh: \x00")
    assert "special characters are not allowed" in refusal(tmp_path / "b.yaml")


def test_values_nested_beyond_reason_are_refused(write):
    path = write("deep.yaml", "mesh: " + "[" * 5000 + "]" * 5000)
    assert refusal(path) == f"{path}, line 1: not valid YAML: its values are nested too deeply"


def test_value_that_unfolds_without_end_is_told_in_a_few_words(write):
    lines = ["x0: &x0 [a, b, c, d, e, f, g, h, i]"]
    lines += [f"x{n}: &x{n} [" + ", ".join([f"*x{n - 1}"] * 9) + "]" for n in range(1, 30)]
    lines += ["mesh: {merge: *x29}", "sequence: *x29"]
    text = "\n".join(lines)
    path = write("bomb.yaml", text)
    assert len(refusal(path)) < 1000
    path = write("ring.yaml", "mesh: {merge: &a [*a]}\nsequence: &b {fps: *b}")
    assert len(refusal(path)) < 1000


@pytest.mark.parametrize("name", ["a.yaml", "./a.yaml", "sub/../a.yaml", "sub/link.yaml"])
def test_file_that_extends_itself_is_refused(write, tmp_path, name):
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "link.yaml").symlink_to(tmp_path / "a.yaml")
    path = write("a.yaml", f"extends: {name}")
    assert f"{path}: extends itself through {path}" in refusal(path)


def test_ring_of_files_is_told_in_its_order(write):
    a, b = write("a.yaml", "extends: b.yaml"), write("b.yaml", "extends: a.yaml")
    assert refusal(a) == f"{a}: extends itself through {a} → {b}"


@pytest.mark.parametrize("parent", ["nothing.yaml", "paper-1066", "[a]", "3", "/"])
def test_what_cannot_be_extended_is_refused_with_what_can(write, parent):
    path = write("a.yaml", f"extends: {parent}")
    message = refusal(path)
    assert message.startswith(f"{path}: extends ")
    assert message.endswith(f"which is neither a preset ({', '.join(PRESETS)}) nor a file")


def test_target_that_is_nothing_is_refused_with_the_presets(tmp_path):
    assert refusal(tmp_path / "no.yaml") == (
        f"{tmp_path / 'no.yaml'}: no such file, output folder or preset; presets: {', '.join(PRESETS)}"
    )
    assert refusal(tmp_path) == (
        f"{tmp_path}: no config.yaml in this folder, so it is not the output of a run; give a YAML file"
    )


@pytest.mark.parametrize("target", [3, 1.5, True, [], b"out"])
def test_target_that_can_be_no_path_is_refused(target):
    words = f"expected a file, an output folder, a preset or a mapping, got {target!r}"
    with pytest.raises(ConfigError, match=f"^{re.escape(words)}$"):
        Pipeline.of(target)


# ── --set ───────────────────────────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("text", ["", "=", "=1", "mesh.merge", ".merge=1", "extends=default"])
def test_set_that_sets_nothing_says_how_it_is_written(text):
    assert refusal(None, text) == f"--set {text}: write task.name=value; kinetree tasks lists every parameter"


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("mesh.mrge=1", "--set mesh.mrge=1: mesh.mrge: no such key; did you mean 'merge'?"),
        ("mseh.merge=1", "--set mseh.merge=1: no such key 'mseh'; did you mean 'mesh'?"),
        ("unknown.task=1", "--set unknown.task=1: no such key 'unknown'; "),
        ("method=fly", "--set method=fly: method 'fly': no such method; "),
        ("mesh.=1", "--set mesh.=1: mesh.: no such key; there are: "),
        ("mesh.merge.x=1", "--set mesh.merge.x=1: mesh.merge: input should be a valid number, got {'x': 1}"),
        ("mesh.merge=[1", "--set mesh.merge=[1, line 1: not valid YAML: "),
        ("mesh.merge=!!python/object:os.system {}", "--set mesh.merge=!!python/object:os.system {}, line 1: not valid YAML: "),
        ("source.frames=2001-13-45", "--set source.frames=2001-13-45: not valid YAML: month must be in 1..12"),
        ("output.x=1", "--set output.x=1: output: expected the path of a folder, got {'x': 1}"),
        ("source.frames=a: b", "--set source.frames=a: b: source.frames: input should be a valid string, got {'a': 'b'}"),
        ("source.frames={2:}", "--set source.frames={2:}: source.frames: input should be a valid string, got "),
        ("mesh=3", "--set mesh=3: mesh: expected keys with values, got 3"),
    ],
)
def test_wrong_set_is_refused_in_words(text, words):
    assert refusal(None, text).startswith(words)


def test_option_and_file_are_each_blamed_for_their_own(write):
    path = write("walk.yaml", "mseh: {merge: 1}\noutput: x")
    assert refusal(path, "mesh.merge=0.1").startswith(f"{path}: no such key 'mseh'; ")
    assert refusal(path, "mseh.merge=0.1").startswith(f"{path}: no such key 'mseh'; ")
    path = write("right.yaml", "mesh: {merge: 0.1}\noutput: x")
    assert refusal(path, "mseh.merge=0.1").startswith("--set mseh.merge=0.1: no such key 'mseh'; ")


# ── names of earlier versions ───────────────────────────────────────────────────────────────────────────────────────


def preset_with(task):
    """A preset whose method has the block."""
    return "default" if task in of().params else "paper-2014"


@pytest.mark.parametrize(("old", "new"), APPLICATION.renamed.items())
def test_an_old_name_is_refused_with_the_one_it_has_now(old, new, write):
    task, _, name = old.partition(".")
    preset = preset_with(new.partition(".")[0])
    words = f"{old}: no such key; it is now {new!r}" if name else f"no such key {task!r}; it is now {new!r}"
    path = write("old.yaml", f"extends: {preset}\n{task}: {{{name or 'x'}: 1}}")
    assert refusal(path) == f"{path}: {words}"
    assert refusal(preset, f"{task}.{name or 'x'}=1") == f"--set {task}.{name or 'x'}=1: {words}"


@pytest.mark.parametrize("new", sorted(set(APPLICATION.renamed.values())))
def test_every_new_name_can_be_set(new):
    task, _, name = new.partition(".")
    params = of(preset_with(task)).params[task]
    assert not name or name in type(params).model_fields


def test_a_name_of_another_method_is_not_offered(write):
    path = write("old.yaml", "extends: paper-2014\ntemplate: {nodes: 100}")
    assert refusal(path).startswith(f"{path}: no such key 'template'; there are: ")


def test_set_into_what_has_no_keys_is_refused():
    assert refusal({"output": "x"}, "output.x=1") == "--set output.x=1: output has no keys of its own"


@pytest.mark.parametrize("frames", ["10:50:2", "1:20", "10:60:2", ":", "0:59:59", "2:", "-5:", "::"])
def test_range_of_frames_is_no_number_to_base_sixty_and_no_key(write, frames):
    assert of(None, f"source.frames={frames}").params["source"].frames == frames
    assert of(None, f"sequence.learn_from= {frames} ").params["sequence"].learn_from == frames
    assert of(write("a.yaml", f"source: {{frames: '{frames}'}}")).params["source"].frames == frames
    if not frames.endswith(":"):
        assert of(write("a.yaml", f"source:\n  frames: {frames}\n")).params["source"].frames == frames


@pytest.mark.parametrize(("text", "value"), [("1e-3", 0.001), ("1E-3", 0.001), (".01", 0.01), ("0", 0.0), ("+0.05", 0.05)])
def test_numbers_are_read_as_people_write_them(text, value):
    assert of(None, f"mesh.merge={text}").params["mesh"].merge == value


def test_values_may_hold_equals_signs_and_spaces():
    assert of(None, "report.title=a=b c").params["report"].title == "a=b c"
    assert of(None, " report.title = mm ").params["report"].title == "mm"


# ── what is kept, and what is never part of a key ───────────────────────────────────────────────────────────────────


@given(
    st.floats(0, 0.09), st.none() | st.floats(1e-3, 1e6), st.text(), st.text(),
    st.none() | st.integers(1, 99), st.sampled_from(["sync", "threads", "processes"]),
)  # fmt: skip
@example(0.0, None, "1e3", "0E0", None, "sync")  # texts to YAML 1.1, numbers to 1.2
def test_saved_configuration_says_the_same_again(merge, fps, title, frames, workers, executor):
    blocks = {
        "mesh": {"merge": merge},
        "sequence": {"fps": fps},
        "report": {"title": title},
        "source": {"input": "/scans/[1]", "frames": frames},
        "output": "/out",
        "compute": {"workers": workers, "executor": executor},
    }
    config = of(blocks)
    again = of(parsed(as_yaml(config.saved()), ""))
    assert again == config


def test_saved_configuration_is_read_back_from_the_output_folder(tmp_path):
    from kinetree.pipeline.output.output import write_config

    config = of({"output": str(tmp_path / "out"), "source": {"input": "x", "frames": "10:50:2"}, "report": {"title": "no"}})
    write_config(config)
    assert of(tmp_path / "out") == config


def test_compute_output_and_store_are_never_in_a_key(tmp_path):
    from kinetree.schemas.input.source import Source

    keys = set()
    for number, compute in enumerate([{}, {"workers": 3, "executor": "sync", "memory": "1GB"}, {"scheduler": "tcp://x:1"}]):
        config = {"output": str(tmp_path / str(number)), "compute": compute}
        pipeline = Pipeline.of(config)
        members = {"source": {(t,): Source(content="ab", path=str(tmp_path / str(number))) for t in range(2)}}
        schedule = configuration_schedule(pipeline, members)
        keys.add(tuple(sorted(e.key for e in schedule.entries.values() if e.key)))
    assert len(keys) == 1
    assert len(next(iter(keys))) == 3  # two meshes, one sequence


def configuration_schedule(pipeline, members):
    from kinetree.pipeline.planning.schedule import Schedule

    return Schedule(pipeline.tasks.until(["mesh", "sequence"]), pipeline.config.params, pipeline.store, members)


def test_compute_is_replaced_where_something_is_said():
    config = with_compute(of({"compute": {"workers": 3, "executor": "sync"}}), workers=None, executor="processes")
    assert (config.compute.workers, config.compute.executor) == (3, "processes")
    with pytest.raises(ConfigError, match=r"compute\.executor: input should be 'sync', 'threads' or 'processes', got 'quick'"):
        with_compute(config, executor="quick")


def test_compute_preset_is_one_of_those_there_are():
    assert refusal({"compute": "no-such-machine"}).startswith("compute 'no-such-machine': no such compute settings; ")


def test_workers_default_to_the_cores_this_process_may_use():
    assert Compute().worker_count == len(os.sched_getaffinity(0))
    assert Compute(workers=7).worker_count == 7


@pytest.mark.parametrize("inside", ["", "artifacts", "a/b"])
def test_output_in_a_store_is_refused(tmp_path, inside):
    there, output = tmp_path / "walk" / "store", tmp_path / "walk" / "store" / inside
    Store.at(there).create()
    assert refusal({"output": str(output)}) == f"config: output {output} lies in the store {there}; name a folder outside of it"
    assert refusal(None, f"output={output}").startswith(f"--set output={output}: output {output} lies in the store {there}; ")
    own = {"store": str(tmp_path / "new"), "output": str(tmp_path / "new" / inside)}
    assert "lies in the store" in refusal(own), "also before it is made"


@pytest.mark.parametrize("key", ["store", "output"])
@pytest.mark.parametrize("address", ["nosuch:/foo", "s3:/bucket/x", "a/gs+x:/foo"])
def test_what_looks_like_the_address_of_a_service_makes_no_folder(tmp_path, monkeypatch, key, address):
    monkeypatch.chdir(tmp_path)
    assert refusal(None, f"{key}={address}") == (
        f"--set {key}={address}: {key}: {tmp_path}/{address} looks like the address of a service, which is not supported;"
        f" give a folder, and make {tmp_path}/{address.partition(':')[0]}: first if it is one"
    )


@pytest.mark.parametrize("name", ["C:/walk", "walk: 1/out", "7:/x", "there:/out", "walk:"])
def test_names_with_colons_are_folders(tmp_path, monkeypatch, name):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "there:").mkdir()
    assert of({"output": name}).output == tmp_path / name


def test_output_among_the_users_own_files_is_refused(tmp_path):
    from kinetree.pipeline import Pipeline

    with pytest.raises(ConfigError, match=r"is also source\.input; name a folder of its own"):
        Pipeline.of({"source": {"input": str(tmp_path)}, "output": str(tmp_path)})
