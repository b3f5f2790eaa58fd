"""Lets every test import helpers such as `shapes` and `results.rigged_bodies`; no example fails on a slow machine."""

import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent))
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")
