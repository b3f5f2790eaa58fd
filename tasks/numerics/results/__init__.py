"""What people take away: comparison with the truth, files for other programs, figures, the report."""
