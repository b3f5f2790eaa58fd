"""Lets every test import helpers such as `shapes` and `results.rigged_bodies`; no example fails on a slow machine."""

import os
import sys
from pathlib import Path

import pytest
from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent))
os.environ["KINETREE_COMPILE_AHEAD"] = "0"  # tests fill the cores themselves
pytest_plugins = ["s3_service"]
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Files at the top first: they run the whole graph, and processes side by side end together if long files begin early."""
    items.sort(key=lambda item: len(item.path.parts))
