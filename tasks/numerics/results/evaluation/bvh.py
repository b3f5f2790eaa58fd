"""BVH, the motion capture format of Biovision: a tree of joints with offsets, then one line of channels a frame.

Local rotation is the product of the rotation channels in their order, angles in degrees; a position channel stands in place of
the same coordinate of the offset, which is how exporters write joints with six channels and how Blender reads them.
"""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from kinetree.errors import InputError

Floats = npt.NDArray[np.float64]
CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
LARGEST = 1e50
END = " end"
"""What is appended to a joint's name to name the end site below it."""


@dataclass(frozen=True, eq=False)
class Bvh:
    """A hierarchy and its motion, joints in the order of the file, parents before children.

    names, parents, ends : (joint,) name, parent or −1, and whether it is an end site
    R                    : (frame, joint, 3, 3) rotation against the parent
    X                    : (frame, joint, xyz) position in the file's unit
    seconds              : from one frame to the next
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    ends: tuple[bool, ...]
    R: Floats
    X: Floats
    seconds: float


def read_bvh(text: str, name: str) -> Bvh:
    """Parses a file and poses the joints in every frame.

    text   : content of the file
    name   : what messages call it
    raises : InputError with the line where the file is not a BVH
    """
    reader = _Reader(text, name)
    reader.expect("HIERARCHY")
    reader.expect("ROOT")
    try:
        reader.joint(-1)
    except RecursionError:
        reader.refuse("joints within joints without end; no body has a limb of so many")
    if reader.peek() == "ROOT":
        reader.refuse("a second ROOT; one body has one")
    reader.expect("MOTION")
    values, seconds = reader.motion()
    R, X = _posed(reader, values)
    return Bvh(tuple(reader.names), tuple(reader.parents), tuple(reader.ends), R, X, seconds)


class _Reader:
    """Words of a file one after the other, and the hierarchy read from them."""

    def __init__(self, text: str, name: str) -> None:
        self.words = [(word, number) for number, line in enumerate(text.splitlines(), 1) for word in line.split()]
        self.at = 0
        self.name = name
        self.names: list[str] = []
        self.parents: list[int] = []
        self.ends: list[bool] = []
        self.offsets: list[list[float]] = []
        self.channels: list[list[str]] = []

    def refuse(self, what: str) -> NoReturn:
        line = self.words[min(self.at, len(self.words) - 1)][1] if self.words else 1
        raise InputError(f"{self.name}, line {line}: {what}")

    def peek(self) -> str:
        return self.words[self.at][0] if self.at < len(self.words) else ""

    def word(self) -> str:
        if self.at == len(self.words):
            self.refuse("the file ends here, in the middle of it; it is not a whole BVH")
        self.at += 1
        return self.words[self.at - 1][0]

    def expect(self, word: str) -> None:
        found = self.peek()
        if found != word:
            self.refuse(f"expected {word}, got {found[:40]!r}; it is not a BVH" if found else f"expected {word}, the file ends")
        self.at += 1

    def number(self) -> float:
        try:
            value = float(self.word())
        except ValueError:
            self.at -= 1
            self.refuse(f"expected a number, got {self.peek()[:40]!r}")
        if not np.isfinite(value):
            self.at -= 1
            self.refuse(f"{self.peek()} is no finite number")
        if abs(value) > LARGEST:
            self.at -= 1
            self.refuse(f"{self.peek()[:40]} is beyond {LARGEST:g}; nothing in a body is so large")
        return value

    def joint(self, parent: int) -> None:
        """A joint and all below it, from its name on."""
        index = self._add(self.word(), parent, end=False)
        self.expect("{")
        self._offset()
        if self.peek() == "CHANNELS":
            self._channels()
        while self.peek() in ("JOINT", "End"):
            if self.word() == "JOINT":
                self.joint(index)
                continue
            self.expect("Site")
            self._add(self.names[index] + END, index, end=True)
            self.expect("{")
            self._offset()
            self.expect("}")
        self.expect("}")

    def motion(self) -> tuple[Floats, float]:
        """(frame, channel) values, and the seconds of a frame."""
        self.expect("Frames:")
        frames = int(self.number())
        self.expect("Frame")
        self.expect("Time:")
        seconds = self.number()
        if frames < 1 or seconds <= 0.0:
            self.refuse(f"{frames} frames of {seconds} seconds; there is no motion in it")
        wanted = sum(map(len, self.channels))
        if not wanted:
            self.refuse("no joint has a channel; there is no motion in it")
        left = len(self.words) - self.at
        if left != frames * wanted:
            self.refuse(f"{frames} frames of {wanted} channels are {frames * wanted} numbers, but {left} follow")
        values = [self.number() for _ in range(left)]
        return np.array(values, dtype=np.float64).reshape(frames, wanted), seconds

    def _add(self, name: str, parent: int, *, end: bool) -> int:
        self.names.append(name)
        self.parents.append(parent)
        self.ends.append(end)
        self.offsets.append([0.0, 0.0, 0.0])
        self.channels.append([])
        return len(self.names) - 1

    def _offset(self) -> None:
        self.expect("OFFSET")
        self.offsets[-1] = [self.number() for _ in range(3)]

    def _channels(self) -> None:
        self.expect("CHANNELS")
        for _ in range(int(self.number())):
            channel = self.word()
            if channel not in CHANNELS or channel in self.channels[-1]:
                self.at -= 1
                self.refuse(f"channel {channel[:40]!r}; expected some of {', '.join(CHANNELS)}, each once")
            self.channels[-1].append(channel)


def _posed(tree: _Reader, values: Floats) -> tuple[Floats, Floats]:
    """Rotations against the parent and positions: x_j = x_p + G_p d_j, G_j = G_p R_j."""
    shape = (len(values), len(tree.names))
    R, G, X = np.tile(np.eye(3), (*shape, 1, 1)), np.empty((*shape, 3, 3)), np.empty((*shape, 3))
    column = 0
    for j, p in enumerate(tree.parents):
        d = np.tile(np.array(tree.offsets[j]), (len(values), 1))
        for channel in tree.channels[j]:
            axis = CHANNELS.index(channel) % 3
            if channel.endswith("position"):
                d[:, axis] = values[:, column]
            else:
                R[:, j] = R[:, j] @ Rotation.from_rotvec(np.radians(values[:, column, None]) * np.eye(3)[axis]).as_matrix()
            column += 1
        X[:, j] = d if p < 0 else X[:, p] + (G[:, p] @ d[:, :, None])[:, :, 0]
        G[:, j] = R[:, j] if p < 0 else G[:, p] @ R[:, j]
    return R, X
