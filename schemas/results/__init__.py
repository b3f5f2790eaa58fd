"""Artifacts and parameters of the shelf `results`."""
