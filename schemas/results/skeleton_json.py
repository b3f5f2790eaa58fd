"""The skeleton as a JSON file, and the model of that file."""

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from kinetree.schemas.results.exports import Exported
from kinetree.schemas.structure.error_bars import EvidenceKind

FORMAT = "kinetree.skeleton/2"
Point = tuple[float, float, float]
Quaternion = tuple[float, float, float, float]
"""x, y, z, w, as in glTF."""
Share = Annotated[float, Field(ge=0, le=1)]


class _FileObject(BaseModel):
    """An object of the file: it has the listed keys and no others."""

    model_config = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True, allow_inf_nan=False)


class Rest(_FileObject):
    """A joint in the reference pose."""

    position: Point
    """Position in the coordinates of the input."""
    offset: Point
    """Position in the axes of the parent: position = parent's position + parent's axes · offset; the root's own position."""
    rotation: Quaternion
    """Axes of the joint against those of its parent, of the root against those of the input; y points along the bone."""


Length = Annotated[float, Field(ge=0)]


class JointError(_FileObject):
    """How far off a joint is expected to be, and the evidence for it; lengths in the file's unit."""

    expected: Length
    """Expected distance from the true joint, mean over the frames."""
    bound: Length
    """Distance that nine joints of ten keep, mean over the frames."""
    drift: Length
    """Root mean square distance between the joint as one of its parts and as the other carries it."""
    spread: Length | None
    """Root mean square distance of the joint over several cuts of the body from their mean; null where one cut alone has it."""
    residual: Length
    """Root mean square of what the motions of its two parts leave unexplained."""
    surface_offset: Length | None = None
    """Root mean square distance from where halves of the frames' surfaces alone have the joint; null where they do not say."""
    asymmetry: Length | None = None
    """Difference between the lengths of the joint's bone and of that bone's mirror image; null where it has none."""
    cuts: Annotated[int, Field(ge=1)]
    """Cuts of the body, each in another pose."""
    agreeing: Annotated[int, Field(ge=0)]
    """Cuts that have the joint."""
    support: Annotated[int, Field(ge=0)]
    """Frames in which its parts were seen."""


class Joint(_FileObject):
    """One joint of the tree."""

    name: str
    """Readable, unique and the same on every run."""
    anatomy: str | None
    """What it is on a person or a four-legged animal, such as knee_l, whatever its name; null where that is not known."""
    parent: Annotated[int, Field(ge=0)] | None
    """Position of its parent in the list of joints, before its own; null for the root."""
    kind: Literal["root", "joint", "leaf", "assumed"]
    """root: no parent; joint: turns against its parent; leaf: the end of a bone, turns with its parent; assumed: the body has
    it, but it was not found, mostly since it never turned: it lies where symmetry or proportions have it; confidence 0."""
    range: Annotated[float, Field(ge=0)]
    """Range of its turning against its parent over the sequence, degrees; 0 for root and leaves, and for joints that no
    motion shows, but where they were fitted to the surface of frames in which they were uncertain."""
    rest: Rest
    """Where it is in the reference pose, and how its axes lie."""
    evidence: EvidenceKind | None = None
    """motion: its parts turn against each other; shape: the body's shape alone shows it; narrowing: a narrowing of its limb
    alone shows it; mirror: the mirror image of its limb alone shows it; no turn was measured at these. null for root and
    leaves, for assumed joints, and where the method does not know."""
    error: JointError | None = None
    """How far off it is expected to be; null for root and leaves, for assumed joints, and where the method does not know."""


class Bone(_FileObject):
    """One bone, from a joint to its parent."""

    parent: Annotated[int, Field(ge=0)]
    """Position of the parent in the list of joints."""
    child: Annotated[int, Field(ge=0)]
    """Position of the child in the list of joints."""
    length: Annotated[float, Field(ge=0)]
    """Length in the file's unit, the same in every frame."""


class InterpolatedFrame(_FileObject):
    """A frame that was not measured; its pose lies between those of the measured frames around it."""

    frame: Annotated[int, Field(ge=0)]
    """Source frame number."""
    cause: Literal["dropped", "missing"]
    """dropped: its file cannot be used; missing: no file has its number."""
    reason: str
    """Why its file cannot be used, in words; empty where there is none."""


class Document(_FileObject):
    """What skeleton.json holds: the joint tree and every joint's position in every frame."""

    format: Literal["kinetree.skeleton/2"]
    """Name and version of this format."""
    unit: str | None
    """Unit of all lengths; null where it is not known."""
    fps: Annotated[float, Field(gt=0)] | None
    """Frames a second; null where it is not known."""
    up: Literal["x", "y", "z", "-x", "-y", "-z"]
    """Axis of the coordinates that points up, as the run found it or was told."""
    up_confidence: Share
    """Confidence in it, 0 to 1."""
    topology: Literal["human", "quadruped", "unknown"]
    """What the body was recognised as."""
    front: Point | None
    """Direction that it faces in the reference pose; null where that is not known."""
    front_confidence: Share
    """Confidence in it, and so in left and right, 0 to 1."""
    frames: list[Annotated[int, Field(ge=0)]]
    """Source frame number of every frame, ascending."""
    seconds: list[Annotated[float, Field(ge=0)]] | None
    """Time of every frame since the first; null where the frame rate is not known."""
    joints: list[Joint]
    """The joints, parents before their children."""
    positions: list[list[Point]]
    """Position of every joint in every frame, [frame][joint][xyz], in the coordinates of the input."""
    rotations: list[list[Quaternion]]
    """Axes of every joint against those of its parent in every frame, [frame][joint][xyzw]; at rest `rest.rotation`."""
    bones: list[Bone]
    """The bones, one for every joint but the root."""
    confidence: list[list[Share]]
    """Confidence of every joint's position in every frame, 0 to 1, [frame][joint]."""
    errors: list[list[Length | None]] | None = None
    """Expected distance of every joint from the true one in every frame, [frame][joint]: larger where the pose is uncertain.
    null where the joint's own error is null, in frames that were not measured, and as a whole where nothing is known."""
    interpolated: list[InterpolatedFrame] = []
    """The frames that were not measured, which have little confidence."""


class SkeletonJson(Exported):
    """skeleton.json: see `Document`."""
