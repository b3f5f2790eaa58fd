"""The tables and figures of the 2014 paper, made anew on one sequence by its preset and by the default."""
