"""What is stored and what may be set: one file per operation, on the ground that `array` and `dims` lay."""

if __name__ != "kinetree.schemas":
    raise ImportError(f"import kinetree.schemas, not {__name__}: the top-level folders are not packages of their own")
