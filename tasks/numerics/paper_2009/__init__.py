"""The 2009 paper: Reeb graphs, their nodes inside the body, forces on graphs, clusters of nodes (Sec. 2)."""
