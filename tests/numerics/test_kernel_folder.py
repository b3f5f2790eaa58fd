"""Where compiled code is kept."""

from pathlib import Path

from kinetree.tasks.numerics.kernel_folder import kernel_folder


def test_the_environment_says_where(monkeypatch):
    monkeypatch.setenv("NUMBA_CACHE_DIR", "/here/it is")
    assert kernel_folder() == Path("/here/it is")
    monkeypatch.setenv("NUMBA_CACHE_DIR", "")
    monkeypatch.setenv("XDG_CACHE_HOME", "/cache")
    assert kernel_folder() == Path("/cache/kinetree")
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", "/home/somebody")
    assert kernel_folder() == Path("/home/somebody/.cache/kinetree")
