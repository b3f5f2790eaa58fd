"""Files for other programs: one module for each format, with a function from a skeleton to its bytes."""
