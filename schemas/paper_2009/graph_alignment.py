"""The mesh of the integrated structure in one frame, as the alignment that every method ends with; no parameters."""
