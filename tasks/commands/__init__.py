"""The commands that speak of bodies and not of graphs, one file each; `kinetree.tasks.application` lists them."""
