"""A data set's file: what it may say, and how what is wrong is refused."""

import json

import pytest

from kinetree.errors import ConfigError, UnknownNodeError
from kinetree.pipeline.application import Application, Shortcut
from kinetree.pipeline.dataset.dataset import Dataset
from kinetree.pipeline.dataset.sequences import matches


@pytest.fixture
def load(toys, tmp_path):
    """Makes the data set of some keys; every take named beside them has one frame."""
    home = tmp_path / "lab"

    def dataset_of(*takes, sets=(), text=None, **keys):
        for take in takes:
            (home / take).mkdir(parents=True)
            (home / take / "00000.txt").write_text("10")
        blocks = {"sequences": "takes/*", "output": "results/{name}", **keys}
        home.mkdir(exist_ok=True)
        (home / "lab.yaml").write_text(
            text if text is not None else json.dumps({k: v for k, v in blocks.items() if v is not None})
        )
        application = Application(
            "toy",
            "Adds numbers.",
            lambda: {"toy": toys.module.GRAPH},
            shortcuts=(Shortcut(("--input",), "source.input", "", is_input=True),),
        )
        return Dataset.of(home / "lab.yaml", sets=sets, application=application)

    dataset_of.home = home
    return dataset_of


def inputs(dataset):
    return dict(dataset.config.inputs)


def test_every_match_of_a_pattern_is_a_sequence_named_by_its_last_part(load):
    dataset = load("takes/b.2", "takes/a")
    assert inputs(dataset) == {name: str(load.home / "takes" / name) for name in ("a", "b.2")}
    assert dataset["a"].config.output == load.home / "results" / "a"
    assert dataset["a"].config.store == load.home / "results" / "store"
    assert dataset["a"].config.params["source"].input == str(load.home / "takes" / "a")


def test_the_name_may_be_made_of_the_folders_above(load):
    dataset = load("mon/walk", "tue/walk", sequences=["mon/*", "tue/*"], name="{parent}-{stem}")
    assert list(dataset) == ["mon-walk", "tue-walk"]


def test_sequences_may_be_listed_and_named(load):
    assert list(load("takes/a", "takes/b", sequences=["takes/b"])) == ["b"]
    dataset = load(sequences={"first": "takes/a", "frames": "takes/b/0*.txt"})
    assert inputs(dataset) == {"first": str(load.home / "takes/a"), "frames": str(load.home / "takes/b/0*.txt")}


def test_a_pattern_that_ends_with_a_slash_takes_folders_alone(load):
    load("takes/a")
    (load.home / "takes" / "notes.txt").write_text("not a sequence")
    assert list(load(sequences="takes/*/")) == ["a"]
    assert list(load(sequences="takes/*")) == ["a", "notes"]


def test_a_listed_sequence_that_is_gone_is_still_one_and_an_empty_pattern_is_noted(load):
    dataset = load("takes/a", sequences=["takes/a", "takes/gone", "late/*"])
    assert list(dataset) == ["a", "gone"]
    assert dataset.config.notes == (f"sequences: nothing matches {load.home}/late/*",)


def test_files_of_one_folder_none_of_which_can_be_read_may_be_frames_of_one_sequence(load):
    load("takes/a")
    for number in range(3):
        (load.home / "takes" / "a" / f"frame_{number}.bin").write_text("x")
    (note,) = load(sequences="takes/a/*.bin").plan().notes
    folder = load.home / "takes" / "a"
    assert note.startswith(
        f"sequences: each of 3 files in {folder} is taken for a sequence; if they are the frames of one, give"
    )
    assert load(sequences="takes/a/*.bin").run()["notes"] == [note]
    assert load(sequences="takes/*").plan().notes == ()


def test_an_option_reaches_all_sequences(load):
    dataset = load("takes/a", "takes/b", sets=["points.scale=7"], overrides={"b": {"points": {"scale": 8}}})
    assert [dataset[name].config.params["points"].scale for name in dataset] == [7.0, 8.0]


def test_a_name_that_overrides_know_and_nobody_has_is_noted(load):
    dataset = load("takes/walk", overrides={"wolk": {"points": {"scale": 2}}})
    assert dataset.config.notes == ("overrides.wolk: no sequence has this name; did you mean 'walk'?",)


@pytest.mark.parametrize(
    ("block", "words"),
    [
        ({"pionts": {}}, "overrides.late_*: no such key 'pionts'; did you mean 'points'?"),
        ({"points": {"scael": 2}}, "overrides.late_*: points.scael: no such key; did you mean 'scale'?"),
        ({"points": {"scale": "x"}}, "overrides.late_*: points.scale: "),
    ],
)
def test_what_overrides_say_of_sequences_to_come_is_checked_too(load, block, words):
    with pytest.raises(ConfigError) as refused:
        load("takes/walk", overrides={"late_*": block})
    assert words in str(refused.value)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"sequences": None}, r"sequences is missing: say which there are, e\.g\. sequences: takes/\*"),
        ({"sequences": "none/*"}, r"sequences: nothing matches .*/none/\*; check the path"),
        ({"sequences": []}, "sequences: expected a pattern such as"),
        ({"sequences": 3}, "sequences: expected a pattern such as .* got 3"),
        ({"sequences": [3]}, "sequences: expected a path or a pattern, got 3"),
        ({"sequences": ["takes/a", "other/a"]}, r"takes/a and .*other/a are both named 'a'; .*\{parent\}-\{stem\}"),
        ({"sequences": {"a/b": "takes/a"}}, "'a/b' cannot be a sequence's name"),
        ({"name": "{stom}-{stem}"}, r"no such field \{stom\}; there are: \{stem\}"),
        ({"name": "all"}, r"name: expected a text with \{stem\}"),
        ({"output": "results"}, r"output: 'results' has no \{name\}; every sequence needs a folder of its own"),
        ({"output": "takes/{name}/out"}, r"output .*/takes/a/out lies in .*/takes/a, the input of a"),
        ({"output": "takes/out/{name}"}, r"lies in .*/takes/out, which the pattern .*/takes/\* would take for a sequence"),
        ({"store": "takes/a/store"}, r"store .*/takes/a/store lies in .*/takes/a, the input of a"),
        ({"store": "results/a"}, r"output .*/results/a lies in the store .*/results/a; name a folder outside of it"),
        ({"sequnces": "x"}, "no such key 'sequnces'; did you mean 'sequences'"),
        ({"points": {"scael": 2}}, r"lab.yaml: points.scael: no such key; did you mean 'scale'"),
        ({"overrides": {"a": {"points": {"scale": "x"}}}}, r"lab.yaml: overrides.a: points.scale: .*number"),
        ({"overrides": {"a": {"pionts": {}}}}, r"lab.yaml: overrides.a: no such key 'pionts'; did you mean 'points'"),
        ({"overrides": {"a": {"output": "x"}}}, "overrides.a: output is the same for all sequences"),
        ({"overrides": ["a"]}, "overrides: expected names of sequences with blocks"),
        ({"source": {"input": "takes/a"}}, "source.input: the sequences say what is read; remove it"),
        ({"metrics": "takes"}, r"metrics: .*/takes is a folder; name a file in it, e\.g\. .*/takes/metrics\.prom"),
        ({"metrics": "/dev/null"}, "metrics: /dev/null is no file, and would be replaced by one"),
        ({"on_failure": "mail me"}, r"on_failure: expected a program and its arguments as a list"),
        ({"retention": {"keep_lst": 1}}, "retention.keep_lst: no such key; did you mean 'keep_last'"),
        ({"retention": {"max_size": "huge"}}, "retention.max_size: expected a size such as 20GB"),
        ({"text": "sequences: [a"}, "lab.yaml, line .*not valid YAML"),
        ({"text": "- a"}, "expected keys with values at the top, got list"),
    ],
)
def test_what_is_wrong_is_refused_with_where_and_what_to_do(load, keys, words):
    with pytest.raises(ConfigError, match=words):
        load("takes/a", "other/a", **keys)


def test_extending_another_data_set_is_refused_with_what_to_do_instead(load):
    load("takes/a")
    (load.home / "other.yaml").write_text("sequences: takes/*\nretention: {keep_last: 3}\n")
    words = (
        r"lab.yaml: extends 'other.yaml', which is a data set itself: it has 'sequences'; .* a file of its own and extend that"
    )
    with pytest.raises(ConfigError, match=words):
        load(extends="other.yaml")
    (load.home / "other.yaml").write_text("points: {scale: 7}\n")
    assert load(extends="other.yaml")["a"].config.params["points"].scale == 7.0


def test_a_file_that_is_not_there_is_refused(load):
    with pytest.raises(ConfigError, match="there is no such file; a data set is a YAML file"):
        Dataset.of("no.yaml", application=load("takes/a").application)


def test_a_sequence_that_does_not_exist_is_refused_with_the_nearest_name(load):
    with pytest.raises(UnknownNodeError, match="did you mean 'walk'"):
        load("takes/walk")["wakl"]


def test_a_pattern_matches_the_paths_that_it_would_find(load):
    home = load.home
    assert matches(home / "takes/a", f"{home}/takes/*")
    assert not matches(home / "takes/a/b", f"{home}/takes/*")
    assert matches(home / "takes/a/b", f"{home}/**/b")
    assert not matches(home / "takes", f"{home}/takes/*")
