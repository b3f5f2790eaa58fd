"""The result is an `Alignment`, as in the default method: the mesh of the skeleton in one frame."""
