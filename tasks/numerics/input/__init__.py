"""Step 0, what is captured: frames, their meshes, whether they share one connectivity (2014, Sec. 3 and 7)."""
