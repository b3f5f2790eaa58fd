"""Measures of a skeleton and its parts against the truth: arrays in, numbers out."""
