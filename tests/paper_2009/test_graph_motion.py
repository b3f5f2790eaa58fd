"""Contract of graph_motion: the integrated structure in all frames, in incoherent ones too."""

from volumetric import FRAMES, volumetric


def test_frames_of_the_model_keep_its_deformation_and_others_are_fitted() -> None:
    here = volumetric(letter=True)
    own = here.integrated_structure.structure
    fitted = {t for t, m in here.graph_motion.items() if m.fitted_here}
    assert fitted == set(range(FRAMES)) - set(here.initial_frames.members("structure/frame", (own,)))
    assert FRAMES // 2 in fitted


def test_default_fits_nothing_twice() -> None:
    assert not any(m.fitted_here for m in volumetric().graph_motion.values())
