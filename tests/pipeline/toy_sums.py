"""The numerics of the toy graph, in a module of their own so that a test can change a formula and nothing else."""


def rough(value: float, grain: float) -> float:
    """The nearest multiple of `grain` at or below `value`."""
    return value // grain * grain


def parity(value: float) -> int:
    """0 for even, 1 for odd."""
    return int(value) % 2
