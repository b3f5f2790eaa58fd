"""A skeleton in the text format of RigNet (Xu et al. 2020): joints, root, hierarchy and skin of the reference mesh."""

from collections.abc import Iterator, Mapping

from kinetree.schemas.structure.skeleton import Skeleton
from kinetree.tasks.results.formats.names import identifiers


def rignet(skeleton: Skeleton) -> Mapping[str, bytes]:
    """The files skeleton.txt and skeleton.obj by name.

    Lines of skeleton.txt: joints NAME X Y Z · root NAME · hier PARENT CHILD · skin VERTEX NAME WEIGHT NAME WEIGHT …; vertices
    are those of skeleton.obj, counted from 0.
    """
    names = identifiers(skeleton.names)
    return {
        "skeleton.txt": "".join(f"{line}\n" for line in _rig(skeleton, names)).encode(),
        "skeleton.obj": "".join(f"{line}\n" for line in _mesh(skeleton)).encode(),
    }


def _rig(skeleton: Skeleton, names: list[str]) -> Iterator[str]:
    """The lines of skeleton.txt."""
    for name, (x, y, z) in zip(names, skeleton.rest.tolist(), strict=True):
        yield f"joints {name} {x:.9g} {y:.9g} {z:.9g}"
    yield f"root {names[0]}"
    for vertex, (joints, weights) in enumerate(zip(skeleton.influence.tolist(), skeleton.weight.tolist(), strict=True)):
        pairs = (f"{names[joint]} {weight:.6f}" for joint, weight in zip(joints, weights, strict=True) if weight > 0)
        yield f"skin {vertex} {' '.join(pairs)}"
    for name, parent in zip(names, skeleton.parents, strict=True):
        if parent >= 0:
            yield f"hier {names[parent]} {name}"


def _mesh(skeleton: Skeleton) -> Iterator[str]:
    """The lines of skeleton.obj."""
    for x, y, z in skeleton.vertices.tolist():
        yield f"v {x:.9g} {y:.9g} {z:.9g}"
    for a, b, c in skeleton.faces.tolist():
        yield f"f {a + 1} {b + 1} {c + 1}"
