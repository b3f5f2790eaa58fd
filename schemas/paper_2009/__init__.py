"""What is stored and what may be set on the shelf `paper_2009`."""
