"""A synthetic sequence with a true skeleton: which figure, how it moves, and how badly it was captured."""

from typing import Annotated, Literal

from pydantic import Field

from kinetree.schemas.array import Params, PathLike

Triple = tuple[float, float, float]


class ContactParams(Params):
    """One limb's end touches another part of the body."""

    limb: str
    """Joint at the end of the limb, e.g. hand_r."""
    target: str
    """Joint that is touched, e.g. hip_r."""
    begin: int
    """First frame of the contact."""
    end: int
    """Last frame of the contact."""
    ramp: int = 5
    """Frames in which the limb comes before, and leaves after."""
    direction: Triple | None = None
    """From the target's joint to the place touched, in the rest pose; None takes where the limb is."""


class DroppedParams(Params):
    """A limb that the reconstruction loses."""

    limb: str
    """Joint beyond which everything is missing."""
    begin: int
    """First frame without it."""
    end: int
    """Last frame without it."""


class SynthParams(Params):
    """What to generate, in place of a captured sequence."""

    figure: str = "human"
    """A figure that ships with kinetree, adult:SEED for a person of other proportions, or random:SEED for a random tree."""
    file: Annotated[str, PathLike()] = ""
    """YAML file of a figure of your own; goes before `figure`."""
    motion: str | None = None
    """One of the figure's motions; None takes the first by name."""
    frames: int = Field(default=36, ge=1)
    """How many frames."""
    fps: float | None = Field(default=None, gt=0)
    """Frames a second; None takes the figure's own."""
    vertices: int = Field(default=3000, ge=100, le=500_000)
    """Vertices of a frame, within about a tenth."""
    clothes: bool = False
    """Whether a person adult:SEED wears loose clothes, which come after the body and fold."""
    contacts: tuple[ContactParams, ...] = ()
    """Which limb touches what, when; there the surface's topology changes."""
    dropped: tuple[DroppedParams, ...] = ()
    """Which limb is missing, when."""
    noise: float = Field(default=0.0, ge=0, lt=0.5)
    """Noise along the normals, root mean square as a share of the height."""
    holes: int = Field(default=0, ge=0)
    """Holes in every frame."""
    hole_size: float = Field(default=0.03, ge=0, lt=0.5)
    """Radius of a hole as a share of the height."""
    connectivity: Literal["new", "fixed"] = "new"
    """new: every frame is surfaced by itself; fixed: one skinned mesh."""
    paint: Literal["none", "patterned", "plain"] = "none"
    """Colours of the skin: clothes with patterns, or plain ones."""
    illumination: float = Field(default=0.0, ge=0, le=1)
    """How far exposure and the direction of light change from frame to frame, 0 to 1; needs `paint`."""
    grain: float = Field(default=0.01, ge=0, lt=0.5)
    """Standard deviation of noise of every vertex's colour, of its range; needs `paint`."""
    seed: int = Field(default=0, ge=0)
    """Of everything random."""
