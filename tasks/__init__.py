"""kinetree.tasks."""

if __name__ != "kinetree.tasks":
    raise ImportError(f"import kinetree.tasks, not {__name__}: the top-level folders are not packages of their own")
