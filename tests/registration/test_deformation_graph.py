"""Contract of deformation_graph: the numerics' graph, whole, in the store's dtypes; nothing at all for fixed connectivity."""

from dataclasses import fields

import numpy as np
import pytest
from pydantic import ValidationError
from shipped import GRAPH
from stepwise import walk

from kinetree.schemas.registration.deformation_graph import DeformationGraphParams
from kinetree.tasks.numerics.registration import deformation_graph as numerics
from kinetree.tasks.numerics.registration.stiffness import PASSES
from kinetree.tasks.registration.deformation_graph import deformation_graph
from kinetree.tasks.registration.pose import graph


def test_stored_graph_is_the_graph_bit_for_bit() -> None:
    reference = walk().reference
    made = numerics.deformation_graph(np.array(reference.vertices), np.array(reference.faces), GRAPH._replace(nodes=200))
    back = graph(walk().deformation_graph)
    for field in fields(made):
        mine, theirs = getattr(made, field.name), getattr(back, field.name)
        assert np.array_equal(mine, theirs), field.name
        assert np.isscalar(mine) or (mine.dtype == theirs.dtype and theirs.flags.writeable), field.name


def test_parameters_reach_the_graph() -> None:
    other = deformation_graph(walk().reference, DeformationGraphParams(nodes=200, samples=2, strut=0.0))
    assert len(other.nodes) == 200
    assert len(other.samples) <= 400 < len(walk().deformation_graph.samples)
    assert len(other.edges) < len(walk().deformation_graph.edges)
    assert len(deformation_graph(walk().reference, DeformationGraphParams(nodes=50)).nodes) == 50


def test_number_of_passes_is_as_asked_for() -> None:
    one = deformation_graph(walk().reference, DeformationGraphParams(nodes=50, passes=5))
    assert list(one.members("pass", ())) == [0, 1, 2, 3, 4]
    assert walk().deformation_graph.passes == DeformationGraphParams().passes == len(PASSES)
    for wrong in (0, 21):
        with pytest.raises(ValidationError, match="passes"):
            DeformationGraphParams(passes=wrong)


def test_fixed_connectivity_needs_no_graph() -> None:
    reference = walk().reference.model_copy(update={"fixed": True})
    empty = deformation_graph(reference, DeformationGraphParams())
    assert all(array.size == 0 for array in empty.arrays().values())
    assert empty.size == reference.size
    assert empty.passes == 0


def test_mesh_of_few_vertices_has_a_node_on_every_second_and_they_are_tied() -> None:
    made = deformation_graph(walk().reference, DeformationGraphParams(nodes=100_000))
    assert len(made.nodes) == len(made.vertices) // 2
    assert np.bincount(made.edges.ravel(), minlength=len(made.nodes)).min() > 0
