"""Positions, confidence, angles and lengths as CSV files."""

from kinetree.schemas.results.exports import Exported


class Tables(Exported):
    """positions.csv, confidence.csv, angles.csv and bones.csv."""
