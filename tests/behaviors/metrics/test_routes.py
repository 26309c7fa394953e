import random
from collections.abc import Sequence
from functools import cache
from itertools import pairwise

import pytest

from behaviors.metrics.routes import Route, random_route
from behaviors.metrics.streets import ALONG, StreetMap
from config.settings import SettingsError
from tests.experiments.helpers import STAGE

ALL = (0, 1, -1)


@cache
def streets(world: str = "manhattan") -> StreetMap:
    return StreetMap(STAGE.plan_of(world))


def drawn(decisions: int, seed: int, quarters: Sequence[int] = ALL) -> Route:
    return random_route(streets(), decisions, quarters, random.Random(seed))


@pytest.mark.parametrize("decisions", [4, 12])
def test_random_route_is_a_loop_without_turning_back(decisions: int) -> None:
    for seed in range(10):
        legs = drawn(decisions, seed).legs
        assert len(legs) == decisions
        for leg, following in pairwise((*legs, legs[0])):
            assert (following.behind, following.way) == (leg.junction, leg.leaves)
            assert leg.leaves in leg.junction.arms
            assert leg.quarters in ALL
            along = ALONG[leg.way]
            ahead = (leg.junction.x_m - leg.behind.x_m, leg.junction.y_m - leg.behind.y_m)
            assert ahead == pytest.approx((1.8 * along[0], 1.8 * along[1]))  # to the next junction, and no farther


def test_no_route_is_a_shorter_one_driven_again() -> None:
    for seed in range(40):
        legs = drawn(8, seed).legs
        assert legs[:4] != legs[4:]


def test_seeds_draw_many_routes_and_the_same_seed_the_same_one() -> None:
    assert drawn(12, 1) == drawn(12, 1)
    assert len({drawn(12, seed).quarters for seed in range(20)}) > 10


def test_random_route_has_allowed_turns_only() -> None:
    assert set(drawn(4, 1, (1,)).quarters) == {1}
    with pytest.raises(SettingsError, match="5 decisions"):
        drawn(5, 1)
