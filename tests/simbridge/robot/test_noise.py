"""Random numbers of the simulation, one by one and many at once."""

import copy
import random

import pytest

from simbridge.robot.noise import Noise


@pytest.mark.parametrize("seed", range(2))
def test_normals_are_those_of_single_draws(seed: int) -> None:
    chance = random.Random(seed)
    single, mixed = Noise(seed, "slip"), Noise(seed, "slip")
    drawn: list[float] = []
    while len(drawn) < 12_000:
        count = chance.choice([1, 7, 1000, 2048, 5000])
        drawn += mixed.normals(count).tolist() if chance.random() < 0.6 else [mixed.normal() for _ in range(count)]
    assert drawn == [single.normal() for _ in drawn]
    assert mixed.drawn == len(drawn)


def test_copied_stream_goes_on_by_itself() -> None:
    noise, alone = Noise(1, "slip"), Noise(1, "slip")
    for each in (noise, alone):
        each.fraction()
        each.normals(100)
        each.normal()
    twin = copy.deepcopy(noise)
    expected = [[alone.normal() for _ in range(3000)], [alone.fraction() for _ in range(3000)], alone.drawn]
    for each in (twin, noise):
        assert [each.normals(3000).tolist(), [each.fraction() for _ in range(3000)], each.drawn] == expected
