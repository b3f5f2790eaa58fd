"""Every dimension an array of kinetree may have, once, with its size where that is fixed; order coarse to fine."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Dim:
    """One dimension: its name, the same in specs, docstrings and zarr `dimension_names`, and its size where fixed."""

    name: str
    size: int | None = None


INTERVAL = Dim("interval")
CONE = Dim("cone")
LEAF = Dim("leaf")
GAP = Dim("gap")
STRUCTURE = Dim("structure")
CONTACT = Dim("contact")
LIMB = Dim("limb")
RUNG = Dim("rung")
ANNULUS = Dim("annulus")
AREA = Dim("area")
BONE = Dim("bone")
FRAME = Dim("frame")
OTHER_FRAME = Dim("other_frame")
RECOVERED = Dim("recovered")
PART = Dim("part")
JOINT = Dim("joint")
CUE = Dim("cue")
PAIR = Dim("pair")
REMOVAL = Dim("removal")
SILHOUETTES = Dim("silhouettes")
VOLUME = Dim("volume")
TRANSITION = Dim("transition")
BIN = Dim("bin")
FINE = Dim("fine")
STATION = Dim("station")
PEAK = Dim("peak")
LOOP = Dim("loop")
CANDIDATE = Dim("candidate")
SOURCE = Dim("source")
BASE = Dim("base")
COMPONENT = Dim("component")
GRID_X = Dim("grid_x")
GRID_Y = Dim("grid_y")
GRID_Z = Dim("grid_z")
VERTEX = Dim("vertex")
INPUT_VERTEX = Dim("input_vertex")
INFLUENCE = Dim("influence", 4)
PAIRING = Dim("pairing", 6)
NEIGHBOUR = Dim("neighbour")
NODE = Dim("node")
SAMPLE = Dim("sample")
BYTE = Dim("byte")
PICTURE = Dim("picture")
EDGE = Dim("edge")
BLOCK = Dim("block")
END = Dim("end", 2)
FACE = Dim("face")
CORNER = Dim("corner", 3)
ROW = Dim("row", 3)
XYZ = Dim("xyz", 3)
