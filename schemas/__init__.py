"""kinetree.schemas."""

if __name__ != "kinetree.schemas":
    raise ImportError(f"import kinetree.schemas, not {__name__}: the top-level folders are not packages of their own")
