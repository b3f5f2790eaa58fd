"""Stored poses, templates and meshes as the numerics take them.

Arrays of their own, writable, so that compiled code meets one kind of array.
"""

import numpy as np

from kinetree.schemas.input.mesh import Mesh
from kinetree.schemas.registration.deformation_graph import DeformationGraph
from kinetree.schemas.registration.pose import Pose
from kinetree.tasks.numerics.registration import deformation
from kinetree.tasks.numerics.registration import deformation_graph as numerics
from kinetree.tasks.numerics.registration.correspondence import Target


def pose(stored: Pose) -> deformation.Pose:
    """A stored pose."""
    return deformation.Pose(np.array(stored.rotation), np.array(stored.translation))


def target(mesh: Mesh, template: DeformationGraph) -> Target:
    """A frame prepared to be fitted."""
    return Target.of(np.array(mesh.vertices), mesh.faces, template.size)


def graph(template: DeformationGraph) -> numerics.DeformationGraph:
    """The deformation graph."""
    return numerics.DeformationGraph(
        V=np.array(template.vertices),
        F=template.faces.astype(np.int64),
        N=np.array(template.normals),
        node=template.nodes.astype(np.int64),
        bound=template.bound.astype(np.int64),
        weight=np.array(template.weight),
        edge=template.ties.astype(np.int64),
        sample=template.samples.astype(np.int64),
        size=template.size,
        start=np.concatenate([[0], np.cumsum(template.degree, dtype=np.int64)]),
        ring=template.ring.astype(np.int64),
        pair=template.blocks.astype(np.int64),
        of_vertex=template.block_of_vertex.astype(np.int64),
        of_edge=template.block_of_tie.astype(np.int64),
    )
