from collections.abc import Iterator

import pytest

from hal.bus import CanBus
from tests.hal.desk_bus import Ride
from tests.hal.helpers import bus_pair


@pytest.fixture
def ends() -> Iterator[tuple[CanBus, CanBus]]:
    """Return the robot's end of a bus and the controller's."""
    robot_end, far_end = bus_pair()
    yield robot_end, far_end
    robot_end.shutdown()
    far_end.shutdown()


@pytest.fixture
def ride() -> Iterator[Ride]:
    """Return a robot on a bus that the test controls, driving at 0.3 m/s."""
    ride = Ride()
    ride.drive_for(1.0)
    ride.sent()
    yield ride
    ride.close()
