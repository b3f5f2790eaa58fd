"""Contract of contact_kinds: only incoherent frames, only what meets from afar."""

from volumetric import volumetric


def test_body_that_touches_nothing_has_no_contact() -> None:
    assert len(volumetric().contact_kinds.frame) == 0
    assert len(volumetric(letter=True).contact_kinds.frame) == 0
