"""Options of dask's clusters of this machine that are begun without a worker."""

INSIDE = {"n_workers": 0, "threads_per_worker": 1, "processes": False, "dashboard_address": "127.0.0.1:0"}
"""Workers are threads of this process."""
NONE = {**INSIDE, "processes": True}
"""Workers are processes."""
