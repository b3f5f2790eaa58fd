"""Contract of limb: each cone by itself, under its number."""

from mesoscopic import made


def test_each_cone_of_each_interval_knows_its_number_and_its_annuli() -> None:
    here = made()
    for (interval, cone), one in here.limb.items():
        assert one.number == cone
        assert one.recovered == ((interval, cone) == (1, 1))
        assert (one.ring == here.consistency.ring[cone, here.consistency.rows(interval)]).all()
