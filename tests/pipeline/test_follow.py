"""A run that follows its input: complete files are computed, growing ones wait, and it ends when it is told to."""

import contextlib
import os

import pytest

from kinetree.errors import ServiceError, SourceError
from kinetree.pipeline.command_line.follow import follow
from kinetree.pipeline.storage.files import Settling


def asked(settling, path):
    settling.look()
    return settling.is_complete(path)


def test_a_file_is_complete_when_it_stood_still_from_one_look_to_the_next(tmp_path):
    path, settling = tmp_path / "a", Settling()
    assert not asked(settling, path)
    path.write_text("1")
    assert not asked(settling, path)
    assert asked(settling, path)
    path.write_text("12")
    assert not asked(settling, path)
    os.utime(path, ns=(1, 1))
    assert not asked(settling, path)
    assert asked(settling, path)
    assert settling.is_complete(path)
    path.unlink()
    assert not asked(settling, path)


class Camera:
    """Writes frames while a run follows them: one step of its script at every pause."""

    def __init__(self, toys, script):
        self.toys, self.script, self.told, self.ran = toys, list(script), [], []

    def pause(self, seconds):
        if not self.script:
            raise KeyboardInterrupt
        step = self.script.pop(0)
        if step:
            step()

    def compute(self, settling):
        self.toys.clear()
        self.toys.pipeline().run(until=("total",), settling=settling)
        self.ran.append([e for e in self.toys.executions() if e.startswith("points")])

    def follow(self, **told):
        return follow(self.toys.pipeline(), self.compute, self.told.append, pause=self.pause, **told)


@pytest.fixture
def empty(toys):
    """The toys, without frames yet."""
    for path in toys.frames.iterdir():
        path.unlink()
    return toys


def test_frames_are_computed_when_they_are_complete(empty):
    growing = empty.frames / "00001.txt"
    script = [
        lambda: empty.write(10),
        lambda: growing.write_text("2"),
        lambda: growing.write_text("20"),
        lambda: empty.write(30, start=2),
        None,
        None,
    ]
    camera = Camera(empty, script)
    assert camera.follow() == 3
    assert camera.ran == [["points-10"], ["points-20"], ["points-30"]]
    assert camera.told == [f"waiting: no frames in {empty.frames}"]
    assert empty.pipeline().artifact("total").frames == (0, 1, 2)


def test_following_ends_when_nothing_new_came_for_long_enough(empty):
    empty.write(10, 20)
    camera = Camera(empty, [None, None, lambda: empty.write(30, start=2), *[None] * 20])
    assert camera.follow(idle=3.0, poll=1.0) == 2
    assert camera.ran == [["points-10", "points-20"], ["points-30"]]
    assert len(camera.script) == 23 - 7  # the first two frames are complete at the first pause, the third at the fourth


def test_input_that_is_wrong_to_the_end_is_refused(empty):
    camera = Camera(empty, [None] * 5)
    with pytest.raises(SourceError, match="no frames in"):
        camera.follow(idle=2.0, poll=1.0)
    assert len(camera.told) == 1


@pytest.mark.parametrize("failures", [1, 9])
def test_service_that_failed_is_asked_again_without_anything_new(empty, failures):
    def compute(settling):
        nonlocal failures
        failures -= 1
        if failures >= 0:
            raise ServiceError("store s3://b: the service answers 503")
        plain(settling)

    empty.write(10)
    camera = Camera(empty, [None] * 9)
    plain, camera.compute = camera.compute, compute
    with contextlib.nullcontext() if failures == 1 else pytest.raises(ServiceError, match="answers 503"):
        assert camera.follow(idle=4.0, poll=1.0) == 1
    assert camera.told == ["waiting: store s3://b: the service answers 503"]
    assert camera.ran == ([["points-10"]] if len(camera.ran) else [])
    assert len(camera.ran) == (failures < 0)


def test_an_interruption_while_nothing_is_under_way_is_the_end(empty):
    empty.write(10)
    assert Camera(empty, [None]).follow() == 1


def test_command_follows_until_idle_and_says_what_failed(toys):
    followed = toys.command("run", str(toys.yaml()), "--follow-idle", "0", "--executor", "sync")
    assert followed.returncode == 0, followed.stderr
    assert followed.stdout.count("done: ") == 1
    toys.flag("fail-points-70")
    toys.write(70, start=6)
    failed = toys.command("run", str(toys.yaml()), "--follow-idle", "0", "--executor", "sync", "--quiet")
    assert failed.returncode == 1
    assert "points[frame=6]" in failed.stderr
