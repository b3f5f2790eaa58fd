"""A short round of the parsers' fuzzing, the same every time: a value or an InputError, whatever the bytes."""

import importlib.util
import random
import sys
from pathlib import Path
from types import ModuleType

import pytest

PATH = Path(__file__).resolve().parent.parent / "benchmarks" / "fuzz.py"
MUTANTS = 40


def benchmark() -> ModuleType:
    spec = importlib.util.spec_from_file_location("fuzz_benchmark", PATH)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


FUZZ = benchmark()


@pytest.mark.parametrize("name", FUZZ.PARSERS)
@pytest.mark.filterwarnings("ignore")
def test_whatever_the_bytes_a_parser_gives_a_value_or_refuses_in_words(name: str, tmp_path: Path, caplog) -> None:
    rng = random.Random(name)
    for seed in FUZZ.PARSERS[name].seeds():
        assert FUZZ.tried(name, seed, tmp_path), "a seed is a valid file"
        refused = 0
        for data in FUZZ.mutants(seed, MUTANTS, rng):
            try:
                refused += not FUZZ.tried(name, data, tmp_path)
            except Exception as error:
                raise AssertionError(f"{name}: {type(error).__name__} at {data!r}") from error
        assert refused > 0, "some mutants are no files"
    assert not caplog.records, "a library's own words reach nobody's terminal"


def test_an_error_of_another_kind_is_no_refusal(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(FUZZ.PARSERS, "broken", FUZZ.Parser(lambda path: path.read_bytes()[99], ".x", lambda: [b"x"]))
    with pytest.raises(IndexError):
        FUZZ.tried("broken", b"x", tmp_path)
