"""Since when: a date, or a time before now."""

import re
import time
from datetime import datetime

from kinetree.errors import ConfigError


def epoch(since: str) -> float:
    """A date, or a time before now such as 36h or 7d, in seconds since the epoch; raises ConfigError."""
    ago = re.fullmatch(r"([0-9]+(?:\.[0-9]+)?)([mhdw])", since.strip())
    if ago:
        return time.time() - float(ago.group(1)) * {"m": 60, "h": 3600, "d": 86400, "w": 604800}[ago.group(2)]
    try:
        return datetime.fromisoformat(since).timestamp()
    except ValueError:
        raise ConfigError(f"--since {since}: expected a date such as 2026-11-20, or a time such as 36h or 7d") from None
