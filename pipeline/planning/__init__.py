"""Which nodes there are, which are up to date and why, which may go next."""
