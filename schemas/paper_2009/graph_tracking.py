"""How the surface that the nodes carry is bent onto each frame (2009, Sec. 3.2 and 4)."""

from kinetree.schemas.registration.tracking import TrackingParams


class GraphTrackingParams(TrackingParams):
    """How the surface is fitted to a frame, from where the nodes carry it."""
