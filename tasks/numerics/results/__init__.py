"""Numerics of the results: reading a truth, comparison with it, the scene of the report."""
