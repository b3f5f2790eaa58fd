"""The input's vertices on the structure's mesh, as the projection that every method ends with; no parameters."""
