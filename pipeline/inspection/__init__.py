"""Questions about a run, answered as values."""
