"""Sizes as people write them."""

import re


def bytes_of(size: str) -> int:
    """A size such as 20GB or 512MiB in bytes; raises ValueError."""
    powers = {letter: power for power, letter in enumerate("kMGT", 1)}
    written = re.fullmatch(r"([0-9]+(?:\.[0-9]+)?) ?([kMGT]i?)?B?", size.strip())
    if written is None:
        raise ValueError("expected a size such as 20GB or 512MiB")
    unit = written.group(2) or ""
    return int(float(written.group(1)) * (1024 if unit.endswith("i") else 1000) ** powers.get(unit[:1], 0))
