"""Views of the product's artifacts: remarks, texts, files and pages by artifact class, one module a shelf."""
