"""Limbs that a reconstruction loses in some frames."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from kinetree.errors import FigureError
from kinetree.tasks.numerics.arrays import Flags
from kinetree.tasks.numerics.input.synth.figures import Figure
from kinetree.tasks.numerics.input.synth.flesh import Flesh

_KEYS = {"limb", "begin", "end"}


@dataclass(frozen=True, eq=False)
class Dropped:
    """Everything beyond a joint is missing in frames begin to end, both included.

    joint : index; limbs : (limb,) what is lost
    """

    joint: int
    begin: int
    end: int
    limbs: Flags

    @classmethod
    def of(cls, figure: Figure, flesh: Flesh, row: Mapping[str, Any], frames: int) -> Dropped:
        """Check a dropped limb written as data: {limb, begin, end}.

        raises : FigureError at an unknown joint, frames outside the clip, or when all or nothing would be lost
        """
        where = f"dropped {dict(row)}"
        if set(row) != _KEYS:
            raise FigureError(f"{where}: expected exactly limb, begin and end")
        joint = figure.index(str(row["limb"]), where)
        begin, end = row["begin"], row["end"]
        if not (isinstance(begin, int) and isinstance(end, int) and 0 <= begin <= end < frames):
            raise FigureError(f"{where}: expected 0 ≤ begin ≤ end < {frames}, the clip's frames")
        limbs = np.isin(flesh.parent, sorted(figure.below(joint)))
        if limbs.all() or not limbs.any():
            lost = "the whole figure" if limbs.all() else "no limb"
            raise FigureError(f"{where}: beyond {row['limb']!r} lies {lost}; name a joint inside a limb")
        return cls(joint, begin, end, limbs)
