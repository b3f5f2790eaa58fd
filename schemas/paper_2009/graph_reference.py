"""The mesh of the integrated structure as the reference of Step II; no parameters."""
