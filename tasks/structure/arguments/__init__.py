"""What several tasks of the shelf make of their arguments."""
