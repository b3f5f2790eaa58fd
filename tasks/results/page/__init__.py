"""The page that shows a run: what goes into it and how it is put together."""
