"""The result is an `Arap`, as in the paper's own Step II: the reference in one frame, here from the default's alignment."""
