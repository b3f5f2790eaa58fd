"""Where bytes lie: artifacts, records, runs, and what is remembered of the user's files."""
