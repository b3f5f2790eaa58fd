"""The scene of a page, from the body that was packed for it."""

import json

import numpy as np

from kinetree.schemas.results.played_body import PlayedBody
from kinetree.tasks.results.page.packing import Packing
from kinetree.tasks.results.page.scene import Scene


def played_scene(played: PlayedBody) -> Scene:
    """What the page contains of it."""
    description = json.loads(played.description)
    packing = Packing(description["arrays"], played.block.tobytes(), played.size, played.checksum)
    return Scene(description, packing, played.omitted, np.array(played.reference_vertex), np.array(played.axes))
