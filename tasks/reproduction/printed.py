"""What the 2014 paper prints: Table 1, seconds a frame by step, and Table 2, errors of eight joints."""

from typing import NamedTuple

HEIGHT = 1500.0
"""Height of the body of Table 2, mm (2014, Sec. 7.1)."""
CITATION = "Mukasa et al., IPSJ Transactions on Computer Vision and Applications 6, 2014"


class PrintedCost(NamedTuple):
    """One row of Table 1; seconds a frame."""

    sequence: str
    vertices: int
    edges: int
    macroscopic: float
    microscopic: float
    mesoscopic: float
    total: float


TABLE_1 = (
    PrintedCost("free", 4_284, 8_564, 3.0, 18.3, 1.2, 22.5),
    PrintedCost("human", 13_000, 27_000, 60.7, 125.1, 4.0, 190.0),
    PrintedCost("head", 68_500, 137_000, 23.5 * 60, 47.6 * 60, 0.3 * 60, 71.4 * 60),
)
"""2014, Table 1: C++ on a Core i7 of 2.3 GHz. The vertices and edges of human and head are printed as "around"."""

TABLE_2 = {
    "left elbow": (17.8, 1.4),
    "right elbow": (33.7, 1.1),
    "left hand": (26.0, 1.1),
    "right hand": (22.1, 1.9),
    "left knee": (31.2, 3.1),
    "right knee": (27.2, 1.0),
    "left toe": (19.9, 2.3),
    "right toe": (21.8, 0.3),
}
"""2014, Table 2: mean error and its standard deviation over 36 frames, mm."""
