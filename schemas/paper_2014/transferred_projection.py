"""The result is a `Projection`, as in the default method: each frame's input vertices on the mesh of the skeleton."""
