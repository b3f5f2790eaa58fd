"""Errors of elbows, hands, knees and toes (2014, Table 2)."""

import re
from collections.abc import Iterable, Mapping

from kinetree.errors import InputError
from kinetree.schemas.results.evaluation import Evaluation, JointScore
from kinetree.tasks.reproduction.printed import CITATION, HEIGHT, TABLE_2
from kinetree.tasks.reproduction.sequence import PRESETS, Run, Sequence
from kinetree.tasks.reproduction.table import Cell, Table

WORDS: Mapping[str, tuple[tuple[str, str], ...]] = {
    "elbow": (("joint", "elbow"), ("joint", "forearm"), ("joint", "lowerarm")),
    "hand": (("tip", "hand"), ("tip", "wrist"), ("tip", "finger"), ("joint", "hand"), ("joint", "wrist")),
    "knee": (("joint", "knee"), ("joint", "shin"), ("joint", "calf"), ("joint", "lowerleg"), ("joint", "leg")),
    "toe": (("tip", "toe"), ("tip", "foot"), ("joint", "toe"), ("joint", "foot")),
}
"""By joint of Table 2, the kinds and words by which a truth may name it, the best first: hands and toes are ends of limbs."""
SIDES = {"l": "left", "left": "left", "r": "right", "right": "right"}
FILLERS = frozenset({"end", "site", "base", "tip", "joint", "effector"})
COLUMNS = ("joint", "printed %", "± %", *(f"{preset} {what}" for preset in PRESETS for what in ("%", "± %", "found")))


def table_2(sequence: Sequence) -> Table:
    """The mean error of eight joints over the frames and its deviation, % of the height, for both methods."""
    matched = [eight_joints(evaluation(sequence.run(preset))) for preset in PRESETS]
    heights = [height for _, height in matched]
    rows: list[tuple[Cell, ...]] = []
    for name, (mean, deviation) in TABLE_2.items():
        cells = [cell for (joints, _), h in zip(matched, heights, strict=True) for cell in _cells(joints[name], h)]
        rows.append((name, 100 * mean / HEIGHT, 100 * deviation / HEIGHT, *cells))
    names = ", ".join(f"{name} {row.name}" for name, row in matched[0][0].items())
    return Table(
        "table-2",
        "Table 2: error of eight joints, % of the height",
        COLUMNS,
        tuple(rows),
        (
            f"printed: {CITATION}; mm on a body of {HEIGHT:.0f} mm, 36 frames",
            "ours: distance from the joint that is matched with the true one; where none is near enough, from the nearest",
            f"joints of the truth: {names}",
        ),
    )


def evaluation(run: Run) -> Evaluation:
    """The comparison with the truth; raises InputError where there is none."""
    stored: Evaluation = run.fetch("evaluation")
    if stored.summary is None:
        raise InputError("no true skeleton is known of this input; name one with --truth FILE")
    return stored


def eight_joints(judged: Evaluation) -> tuple[dict[str, JointScore], float]:
    """The true joints of Table 2 by its own names, and the height of the body; raises InputError where one is not there."""
    picked = {name: _picked(name, judged.joints) for name in TABLE_2}
    joints = {name: row for name, row in picked.items() if row is not None}
    if len(joints) < len(picked):
        missing = ", ".join(name for name in picked if name not in joints)
        there = ", ".join(row.name for row in judged.joints)
        raise InputError(
            f"{judged.truth}: Table 2 needs elbows, hands, knees and toes on both sides, and no joint is named as {missing};"
            f" the truth has {there}; name joints such as elbow_l or RightKnee"
        )
    return joints, judged.height


def _picked(name: str, rows: Iterable[JointScore]) -> JointScore | None:
    """The row that is named best; of equals the one with the shortest name, then the first."""
    side, what = name.split()
    mine = [row for row in rows if side_of(row.name) == side]
    for kind, word in WORDS[what]:
        named = [row for row in mine if (row.kind == "tip") == (kind == "tip") and _says(row.name, word)]
        if named:
            return min(named, key=lambda row: len(row.name))
    return None


def side_of(name: str) -> str | None:
    """left, right or None, by a word of a joint's name: elbow_l, LeftHand, foot.R, lToe."""
    sides = {SIDES[word] for word in _words(name) if word in SIDES}
    return sides.pop() if len(sides) == 1 else None


def _says(name: str, word: str) -> bool:
    rest = "".join(w for w in _words(name) if w not in SIDES and w not in FILLERS and not w.isdigit())
    return rest == word if word == "leg" else word in rest


def _words(name: str) -> list[str]:
    """The words of a name in lower case, split at capitals, digits and signs; r or l before a capital is a word."""
    return [word.lower() for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+", name.rpartition(":")[2])]


def _cells(row: JointScore, height: float) -> tuple[Cell, ...]:
    if row.mean is None or row.deviation is None:
        return row.nearest, None, "no"
    return row.percent, 100 * row.deviation / height, "yes"
