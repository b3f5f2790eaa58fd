"""kinetree.pipeline."""

if __name__ != "kinetree.pipeline":
    raise ImportError(f"import kinetree.pipeline, not {__name__}: the top-level folders are not packages of their own")
