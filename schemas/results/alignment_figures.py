"""Pictures of the alignment, and how near the skin is to it."""

from kinetree.schemas.results.figures import Figures


class AlignmentFigures(Figures):
    """Distance of the aligned mesh from every frame; no picture where nothing was aligned."""

    reference: int
    """Source frame number at which the aligned mesh is the reference mesh, or nearest to it."""
    skin_distance: float
    """Root mean square distance between the skinned and the aligned mesh in some frames, share of the body's diagonal."""
