"""Cones matched across intervals, erroneous ones rejected, lost ones recovered (2014, Sec. 6.1.1.2 to 6.1.1.4, Eqs. 7, 8)."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.int64]

SAME = 0.5
"""Share of the smaller of two cones that must lie in the other, carried over a cut, for both to be of one limb."""


class Seen(NamedTuple):
    """The cones of one interval.

    ring : (leaf, vertex) annulus, −1 beyond the cone; area : (vertex,) mesh unit²
    span : (leaf,) range of μ in the cone
    """

    ring: Ints
    area: Floats
    span: Floats

    def rank(self, leaf: int) -> tuple[int, float]:
        """How long a bone the cone can hold: its number of annuli, then the range of μ (Sec. 6.1.1.3)."""
        return int(self.ring[leaf].max(initial=-1)), float(self.span[leaf])


class Cut(NamedTuple):
    """What is known of two successive intervals where they meet.

    onward, backward    : (vertex,) of the first, in the second; of the second, in the first; −1 for none
    before, behind      : (pair,) leaves that are mutually nearest
    moved               : (pair,) how far they are apart, mesh unit
    """

    onward: Ints
    backward: Ints
    before: Ints
    behind: Ints
    moved: Floats


class Limbs(NamedTuple):
    """One set of cones for the whole sequence.

    ring : of each interval, (limb, vertex) annulus, −1 beyond the cone
    leaf : (interval, limb) the leaf that was seen, −1 where the cone was recovered
    """

    ring: tuple[Ints, ...]
    leaf: Ints


def limbs(seen: list[Seen], cuts: list[Cut], threshold: float) -> Limbs:
    """Walks along the intervals and back.

    threshold : θ of Eq. 7, how far a leaf may move between two frames, mesh unit
    """
    linked, erroneous = _linked(seen, cuts, threshold)
    alive = [[n for n in range(len(s.ring)) if (i, n) not in erroneous and s.ring[n].max(initial=-1) >= 0]
             for i, s in enumerate(seen)]  # fmt: skip
    leaf = [dict(enumerate(alive[0]))]
    ring = [{limb: seen[0].ring[n] for limb, n in leaf[0].items()}]
    number = len(leaf[0])
    for i, cut in enumerate(cuts):
        carried = {limb: carry(r, cut.backward) for limb, r in ring[i].items()}
        here: dict[int, int] = {}
        fresh = list(alive[i + 1])
        for limb, n in leaf[i].items():
            partner = linked[i].get(n, -1)
            if partner in fresh:
                here[limb] = partner
                fresh.remove(partner)
        waiting = [limb for limb in carried if limb not in here]
        for n in fresh:
            shares = [shared(carried[limb], seen[i + 1].ring[n], seen[i + 1].area) for limb in waiting]
            if shares and max(shares) >= SAME:
                limb = waiting.pop(int(np.argmax(shares)))
                here[limb] = n
            else:
                here[number], number = n, number + 1
        ring.append({**carried, **{limb: seen[i + 1].ring[n] for limb, n in here.items()}})
        leaf.append(here)
    for i in range(len(cuts) - 1, -1, -1):
        for limb, r in ring[i + 1].items():
            if limb not in ring[i]:
                ring[i][limb] = carry(r, cuts[i].onward)
    rows = tuple(
        np.array([r[limb] for limb in range(number)], np.int64).reshape(number, len(s.area))
        for r, s in zip(ring, seen, strict=True)
    )
    leaves = np.array([[at.get(limb, -1) for limb in range(number)] for at in leaf], np.int64)
    return Limbs(rows, leaves.reshape(len(seen), number))


def carry(ring: Ints, source: Ints) -> Ints:
    """Gives every vertex the annulus of the vertex that it was mapped onto, v_j' ∈ A^k if v_j ∈ A^k  (Eq. 8).

    Eq. 8 takes the lost cone out of what may be mapped onto, and then asks what was mapped onto it; we leave it in.

    ring    : (vertex,) before the cut, source : (vertex,) behind it, the vertex before; −1 for none
    """
    return np.where(source >= 0, ring[source], -1)


def shared(a: Ints, b: Ints, area: Floats) -> float:
    """Area common to two cones, as share of the smaller."""
    both, least = area[(a >= 0) & (b >= 0)].sum(), min(area[a >= 0].sum(), area[b >= 0].sum())
    return float(both / least) if least > 0.0 else 0.0


def _linked(seen: list[Seen], cuts: list[Cut], threshold: float) -> tuple[list[dict[int, int]], set[tuple[int, int]]]:
    """Per cut the leaf behind it of each leaf before it, and the erroneous cones as interval and leaf.

    Of two leaves that Eq. 7 finds too far apart the cone with fewer annuli goes; so does that of two leaves, both left
    without a partner, of which one's cone lies in the other's.
    """
    linked: list[dict[int, int]] = []
    erroneous: set[tuple[int, int]] = set()
    for i, cut in enumerate(cuts):
        a, b = seen[i], seen[i + 1]
        pairs = list(zip(cut.before.tolist(), cut.behind.tolist(), cut.moved.tolist(), strict=True))
        linked.append({n: m for n, m, moved in pairs if moved <= threshold})
        doubtful = [(n, m) for n, m, moved in pairs if moved > threshold]
        alone = [n for n in range(len(a.ring)) if n not in cut.before]
        other = [m for m in range(len(b.ring)) if m not in cut.behind]
        doubtful += [(n, m) for n in alone for m in other if shared(carry(a.ring[n], cut.backward), b.ring[m], b.area) >= SAME]
        for n, m in doubtful:
            erroneous.add((i, n) if a.rank(n) < b.rank(m) else (i + 1, m))
    return linked, erroneous
