"""The reference bent onto one frame from its neighbour's pose (2014, Sec. 5.3)."""

from typing import Annotated

from pydantic import Field

from kinetree.schemas.array import Array, Floats, Params
from kinetree.schemas.dims import NODE, ROW, XYZ
from kinetree.schemas.registration.pose import Pose

_Range = tuple[Annotated[float, Field(gt=0)], Annotated[float, Field(gt=0)]]
"""At the first step and at the last, between them geometric."""


class TrackingParams(Params):
    """How the reference is fitted to a frame; of a pair, the first step takes the first value, the last the second.

    In the chain frames are fitted so where few points do not suffice; every frame then has the last six of ten such steps.
    """

    steps: int = Field(default=10, ge=1, le=1000)
    """Gauss–Newton steps; of the pairs below the first step takes the first value and the last step the second."""
    stiffness: _Range = (0.2, 0.002)
    """Weight λ of the graph's edges against the surface: higher keeps the shape, lower follows the frame."""
    reach: _Range = (0.08, 0.027)
    """Matches of points farther apart do not count, share of the root of the area."""
    scale: _Range = (0.04, 0.008)
    """Distance from the surface at which a match counts a quarter, share of the root of the area."""
    point_weight: _Range = (0.05, 0.002)
    """Weight of the distance between matched points against that from the surface."""
    solver_steps: int = Field(default=30, ge=1, le=10_000)
    """Conjugate-gradient steps in each Gauss–Newton step, at most."""


class Tracking(Pose):
    """A frame of the chain outwards from the reference: near enough for a fit, with what the next frame needs to start from."""

    frame: int = 0
    """Source frame number; 0 also where poses are not predicted from it."""
    earlier_frame: int = 0
    """Source frame number of the frame before in the chain, which may be some frames away."""
    steps: int
    """Steps from the reference to this frame, in the order in which frames are reached; 0 for the reference."""
    unexplained: float
    """Share of the frame that the body does not explain: of its few points, those far from the body."""
    usual: float
    """Smallest such share of any frame between the reference and this one: holes of a capture."""
    attempt: int
    """How the frame was fitted: 0 by few points, else with all samples, 1 in the usual way, above 1 in another one."""
    earlier_rotation: Annotated[Floats, Array("float64", NODE, ROW, XYZ)]
    """R of the frame before in the chain, from which to predict the next."""
    earlier_translation: Annotated[Floats, Array("float64", NODE, XYZ, unit="length")]
    """p of the frame before."""
    fitting: TrackingParams = TrackingParams()
    """How a frame is fitted with all samples; what fits frames later on does it alike."""
