"""The guard's small print: what the stories do not come by, and what a changed sign or number would break."""

import math

import pytest

from hal import guard as words
from hal.bus import CanBus
from hal.robot import STANDSTILL, Grant, WheelSpeeds
from tests.hal.helpers import fresh
from tests.hal.test_guard import Driver

Ends = tuple[CanBus, CanBus]


@pytest.fixture
def driver(ends: Ends) -> Driver:
    return Driver(ends)


@pytest.mark.parametrize("age_s", [-0.5, -1e-6, -math.inf])
@pytest.mark.parametrize("kind", range(3))
def test_frames_from_after_the_senses_are_no_proof(driver: Driver, kind: int, age_s: float) -> None:
    ages_s = [age_s if at == kind else 0.0 for at in range(3)]
    reason = (words.INFRARED_STALE, words.ENCODER_STALE, words.BUMPER_STALE)[kind]
    senses = fresh(driver.now_s, 0, *ages_s)
    assert driver.tell(WheelSpeeds(0.3, 0.3), senses) == Grant(STANDSTILL, (reason,), latched=False)
