"""Results for people and programs: comparison with the truth, exported files, figures, the report."""
