import random
from collections.abc import Sequence
from functools import cache

import pytest

from behaviors.metrics.routes import Route, random_route
from behaviors.metrics.streets import StreetMap
from config.settings import SettingsError
from tests.experiments.helpers import STAGE

ALL = (0, 1, -1)


@cache
def streets(world: str = "manhattan") -> StreetMap:
    return StreetMap(STAGE.plan_of(world))


def drawn(decisions: int, seed: int, quarters: Sequence[int] = ALL) -> Route:
    return random_route(streets(), decisions, quarters, random.Random(seed))


def test_random_route_has_allowed_turns_only() -> None:
    assert set(drawn(4, 1, (1,)).quarters) == {1}
    with pytest.raises(SettingsError, match="5 decisions"):
        drawn(5, 1)
