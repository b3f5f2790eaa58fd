"""Identity: of values, of code, of what a node will compute."""
