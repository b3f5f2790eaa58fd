"""Step I, the macroscopic view: μ, how it changes, intervals, extremities (2014, Sec. 4 and 5.1)."""
