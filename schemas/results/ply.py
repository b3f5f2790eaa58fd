"""The user's own meshes with their parts: a PLY file a frame."""

from collections.abc import Mapping

from kinetree.schemas.array import Index
from kinetree.schemas.results.exports import Exported


class Ply(Exported):
    """One frame's mesh as it was given, every vertex with the colour and the number of its part."""

    def files(self, index: Index) -> Mapping[str, bytes]:
        """The file, named by the frame."""
        (data,) = super().files(index).values()
        return {f"parts/frame_{index[0]:04d}.ply": data}
