"""Step II, the microscopic view: one reference mesh brought to every frame (2014, Sec. 5.2 and 5.3)."""
