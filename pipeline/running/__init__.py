"""Parcels of nodes out to workers, results back."""
