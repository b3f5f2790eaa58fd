"""What every frame's input vertices are on the mesh of the finished skeleton; the results are `Projection`s."""
