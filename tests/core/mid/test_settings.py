"""Settings of mid levels."""

from kurt2rt.core.mid.settings import load_mid_level


def test_builtin_mid_level_matches_the_paper() -> None:
    mid = load_mid_level("turns")
    assert (mid.space.dimensions, mid.space.radius, mid.space.metric) == (12, 6.0, "hamming")
    assert mid.situation.kind == "history"
    assert mid.features[0] == "symbol 1"
    assert load_mid_level(mid) is mid
