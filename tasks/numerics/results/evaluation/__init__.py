"""How good a skeleton and its parts are against the truth: numpy in, numbers out."""
