"""Reads BVH, Biovision's format of motion capture: a tree of joints with offsets, then one line of channels a frame.

The rotation of a joint against its parent is the product of its rotation channels in their order, angles in degrees. A position
channel replaces the same coordinate of the offset: exporters write joints with six channels so, and Blender reads them so.
"""

from dataclasses import dataclass
from typing import NoReturn

import numpy as np

from kinetree.errors import InputError
from kinetree.tasks.numerics.arrays import Floats

CHANNELS = tuple(f"{axis}{kind}" for kind in ("position", "rotation") for axis in "XYZ")
LARGEST_NUMBER = 1e50
"""Largest absolute value of a number in a truth: squares of larger ones may overflow, and no unit makes a body so large."""
END_SUFFIX = " end"
"""Appended to a joint's name to name the end site below it."""


@dataclass(frozen=True, eq=False)
class Bvh:
    """A hierarchy and its motion; joints in the order of the file, parents before children.

    names        : (joint,)
    parents      : (joint,) parent of every joint, −1 for the root
    is_end_site  : (joint,) whether it is the end of a bone, without channels
    R            : (frame, joint, 3, 3) rotation against the parent
    X            : (frame, joint, xyz) position in the file's unit
    frame_time   : seconds from one frame to the next
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    is_end_site: tuple[bool, ...]
    R: Floats
    X: Floats
    frame_time: float


def read_bvh(text: str, name: str) -> Bvh:
    """Parses a BVH file and computes the position of every joint in every frame.

    text   : content of the file
    name   : name of the file, for messages
    raises : InputError with the number of the line where the file is not a BVH
    """
    reader = _Reader(text, name)
    reader.expect("HIERARCHY")
    reader.expect("ROOT")
    try:
        reader.joint(-1)
    except RecursionError:
        reader.refuse("joints are nested too deep; no body has so long a chain")
    if reader.peek() == "ROOT":
        reader.refuse("a second ROOT; one body has one")
    reader.expect("MOTION")
    values, frame_time = reader.motion()
    R, X = _posed(reader, values)
    return Bvh(tuple(reader.names), tuple(reader.parents), tuple(reader.is_end_site), R, X, frame_time)


class _Reader:
    """Reads the words of a file one after the other into lists, one element a joint."""

    def __init__(self, text: str, name: str) -> None:
        self.words = [(word, number) for number, line in enumerate(text.splitlines(), 1) for word in line.split()]
        self.at = 0
        self.name = name
        self.names: list[str] = []
        self.parents: list[int] = []
        self.is_end_site: list[bool] = []
        self.offsets: list[list[float]] = []
        self.channels: list[list[str]] = []

    def refuse(self, what: str) -> NoReturn:
        line = self.words[min(self.at, len(self.words) - 1)][1] if self.words else 1
        raise InputError(f"{self.name}, line {line}: {what}")

    def peek(self) -> str:
        return self.words[self.at][0] if self.at < len(self.words) else ""

    def word(self) -> str:
        if self.at == len(self.words):
            self.refuse("the file ends here; it is not a complete BVH")
        self.at += 1
        return self.words[self.at - 1][0]

    def expect(self, word: str) -> None:
        got = self.peek()
        if got != word:
            self.refuse(f"expected {word}, got {got[:40]!r}; it is not a BVH" if got else f"expected {word}, but the file ends")
        self.at += 1

    def number(self) -> float:
        try:
            value = float(self.word())
        except ValueError:
            self.at -= 1
            self.refuse(f"expected a number, got {self.peek()[:40]!r}")
        if not np.isfinite(value):
            self.at -= 1
            self.refuse(f"{self.peek()} is not a finite number")
        if abs(value) > LARGEST_NUMBER:
            self.at -= 1
            self.refuse(f"{self.peek()[:40]} is larger than {LARGEST_NUMBER:g}; no body is so large")
        return value

    def joint(self, parent: int) -> None:
        """Reads a joint and all joints below it, from its name on."""
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
            self._add(self.names[index] + END_SUFFIX, index, end=True)
            self.expect("{")
            self._offset()
            self.expect("}")
        self.expect("}")

    def motion(self) -> tuple[Floats, float]:
        """(frame, channel) values, and the seconds from one frame to the next."""
        self.expect("Frames:")
        frames = int(self.number())
        self.expect("Frame")
        self.expect("Time:")
        frame_time = self.number()
        if frames < 1 or frame_time <= 0.0:
            self.refuse(f"{frames} frames of {frame_time} seconds; there is no motion in it")
        channels = sum(map(len, self.channels))
        if not channels:
            self.refuse("no joint has a channel; there is no motion in it")
        count = len(self.words) - self.at
        if count != frames * channels:
            self.refuse(f"{frames} frames of {channels} channels are {frames * channels} numbers, but {count} follow")
        values = [self.number() for _ in range(count)]
        return np.array(values, dtype=np.float64).reshape(frames, channels), frame_time

    def _add(self, name: str, parent: int, *, end: bool) -> int:
        self.names.append(name)
        self.parents.append(parent)
        self.is_end_site.append(end)
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
                self.refuse(f"channel {channel[:40]!r}; expected each of {', '.join(CHANNELS)} at most once")
            self.channels[-1].append(channel)


def _posed(tree: _Reader, values: Floats) -> tuple[Floats, Floats]:
    """(frame, joint, 3, 3) rotations against the parent, (frame, joint, xyz) positions: x_j = x_p + G_p d_j, G_j = G_p R_j."""
    from scipy.spatial.transform import Rotation  # a truth of another format does without scipy

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
