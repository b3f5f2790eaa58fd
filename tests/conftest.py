"""Lets every test import `shapes`; no example fails for being slow on a busy machine."""

import sys
from pathlib import Path

from hypothesis import settings

sys.path.insert(0, str(Path(__file__).resolve().parent))
settings.register_profile("any machine", deadline=None)
settings.load_profile("any machine")
