"""A tube that bends at its middle: the body that is registered, and the frames that it is registered to."""

import pytest
from limbs import ANGLES, bent, tube
from shipped import GRAPH

from kinetree.tasks.numerics.registration.correspondence import Target
from kinetree.tasks.numerics.registration.deformation_graph import deformation_graph


@pytest.fixture(scope="session")
def body():
    """The straight tube with a deformation graph of 80 nodes."""
    return deformation_graph(*tube(), GRAPH._replace(nodes=80))


@pytest.fixture(scope="session")
def targets(body):
    """The tube bent by each of ANGLES, cut into other vertices and faces than the body."""
    V, F = tube(around=29, along=57, start=0.07)
    return [Target.of(bent(V, angle), F, body.size) for angle in ANGLES]
