"""Files that other programs read: one module a format, each a function from a skeleton to bytes."""
