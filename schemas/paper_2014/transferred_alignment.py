"""What the task gives is an `Alignment`, as the default's is: the mesh of the finished skeleton in one frame."""
