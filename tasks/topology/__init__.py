"""Step I, the macroscopic view: μ, how it changes, intervals, extremities (2014, Sec. 4 and 5.1)."""

from kinetree.tasks.topology.correlation import correlation
from kinetree.tasks.topology.extrema import extrema
from kinetree.tasks.topology.geodesics import geodesics
from kinetree.tasks.topology.intervals import intervals
from kinetree.tasks.topology.leaves import leaves
from kinetree.tasks.topology.mu_histogram import mu_histogram
from kinetree.tasks.topology.up_direction import up_direction

TOPOLOGY = (
    geodesics,
    mu_histogram,
    correlation,
    extrema,
    intervals,
    leaves,
    up_direction,
)
