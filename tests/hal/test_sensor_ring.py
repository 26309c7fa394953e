"""Neighbours of infra-red sensors and the readings that replace a broken sensor's."""

import pytest

from hal.kurt2_settings import load_kurt2
from hal.sensor_ring import SubstituteReadings, neighbours_of

INFRARED = load_kurt2().infrared
PLACES = {name: place for place, name in enumerate(INFRARED.names)}


def counts_of(**readings: int) -> tuple[int, ...]:
    """Return the readings of all sensors: 70 counts, except the given ones."""
    return tuple(readings.get(name, 70) for name in INFRARED.names)


@pytest.mark.parametrize(
    ("sensor", "before", "after", "substitutes"),
    [
        ("s3", "s1", "s4", {"s1", "s4"}),
        ("s1", "s15", "s3", {"s3"}),
        ("s15", "s9", "s1", {"s9", "s1"}),
        ("s9", "s11", "s15", {"s11"}),
        ("s11", "s10", "s9", {"s10", "s9"}),
        ("s14", "s12", "s13", {"s12", "s13"}),
        ("s18", "s13", "s6", {"s13", "s6"}),
    ],
)
def test_neighbours_stand_next_to_a_sensor(sensor: str, before: str, after: str, substitutes: set[str]) -> None:
    near = neighbours_of(INFRARED.sensors)[PLACES[sensor]]
    assert (near.before, near.after) == (PLACES[before], PLACES[after])
    assert set(near.substitutes) == {PLACES[each] for each in substitutes}


def test_substitute_of_a_sensor_is_the_highest_neighbour() -> None:
    read = SubstituteReadings(INFRARED)(counts_of(s1=301, s9=100, s15=0), (PLACES["s15"],))
    assert read == counts_of(s1=301, s9=100, s15=301)


def test_substitute_leaves_out_a_broken_neighbour() -> None:
    read = SubstituteReadings(INFRARED)(counts_of(s1=550, s9=100, s15=0, s3=240), (PLACES["s15"], PLACES["s1"]))
    assert read == counts_of(s1=240, s9=100, s15=100, s3=240)


def test_substitute_without_a_working_neighbour_reads_near() -> None:
    read = SubstituteReadings(INFRARED)(counts_of(s9=0, s11=0, s10=150), (PLACES["s9"], PLACES["s11"]))
    assert read == counts_of(s9=INFRARED.plateau_counts, s11=150, s10=150)


def test_neighbours_of_kurt2_are_all_witnesses() -> None:
    assert all(near.has_witnesses for near in neighbours_of(INFRARED.sensors))


def test_neighbours_across_a_gap_are_no_witnesses() -> None:
    # Five sensors ahead, 20 degrees apart, and one behind: those at the ends have a neighbour that looks elsewhere.
    ahead = [INFRARED.sensors[0].model_copy(update={"heading_deg": heading}) for heading in (40, 20, 0, -20, -40, 180)]
    assert [near.has_witnesses for near in neighbours_of(ahead)] == [False, True, True, True, False, False]
