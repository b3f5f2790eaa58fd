"""What people see of results and take away: remarks, texts, files and pages by artifact class, one file a shelf."""
