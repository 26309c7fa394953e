"""The guard's small print: what the stories do not come by, and what a changed sign or number would break."""

import math

import pytest

from hal import guard as words
from hal.bus import CanBus
from hal.robot import STANDSTILL, Grant, Senses, WheelSpeeds
from tests.hal.helpers import fresh
from tests.hal.test_guard import Driver

Ends = tuple[CanBus, CanBus]


@pytest.fixture
def driver(ends: Ends) -> Driver:
    return Driver(ends)


@pytest.mark.parametrize(
    ("field", "reason"),
    [
        ("infrared_age_s", words.INFRARED_STALE),
        ("encoder_age_s", words.ENCODER_STALE),
        ("bumper_age_s", words.BUMPER_STALE),
    ],
)
@pytest.mark.parametrize("age_s", [-0.5, -1e-6, -math.inf])
def test_frames_from_after_the_senses_are_no_proof(driver: Driver, field: str, reason: str, age_s: float) -> None:
    senses: Senses = fresh(driver.now_s)._replace(**{field: age_s})
    assert driver.tell(WheelSpeeds(0.3, 0.3), senses) == Grant(STANDSTILL, (reason,), latched=False)
