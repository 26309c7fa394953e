"""Bus that goes and comes back under the simulated robot."""

from collections.abc import Iterator

import pytest

from hal.bus import BusError, CanBus, CanInterface, open_bus
from hal.control import Mode, SpeedControl, control_frame
from hal.in_process_bus import InProcessBus
from simbridge.controller.reconnecting_bus import ReconnectingBus
from simbridge.simulated_robot import SimulatedKurt2
from tests.simbridge.rig import ROBOT, room

SLOWLY = control_frame(SpeedControl(Mode.SPEED_CM, 20, 20))


class Adapter:
    """Controller's bus whose adapter can be unplugged, and a clock moved by the test."""

    def __init__(self) -> None:
        self.plugged_in = True
        self.now_s = 0.0
        self.tries = 0
        self.bus = CanBus("desk", self._open)
        self.steady = ReconnectingBus(self.bus, lambda: self.now_s)
        self.notebook = open_bus("virtual:steady-bus-test")
        self.control = self.notebook.control_port()
        self._end: InProcessBus

    def _open(self, name: str) -> CanInterface:
        self.tries += 1
        if not self.plugged_in:
            raise BusError(f"bus {name!r}: no such network interface")
        self._end = InProcessBus("steady-bus-test")
        return self._end

    def unplug(self) -> None:
        self.plugged_in = False
        self._end.shutdown()


@pytest.fixture
def adapter() -> Iterator[Adapter]:
    adapter = Adapter()
    yield adapter
    adapter.bus.shutdown()
    adapter.notebook.shutdown()


def test_reconnecting_bus_robot_stands_while_it_is_gone(adapter: Adapter) -> None:
    robot = SimulatedKurt2(ROBOT, room(), adapter.steady, seed=1)

    def cycles(count: int) -> None:
        for _ in range(count):
            adapter.now_s += ROBOT.cycle_s
            adapter.control.send(SLOWLY)
            robot.step()
            adapter.notebook.drain()

    cycles(50)
    assert min(robot.wheel_speeds) > 0.1
    assert not robot.controller.watchdog_expired
    adapter.unplug()
    cycles(60)
    assert robot.controller.watchdog_expired
    assert robot.wheel_speeds == (0.0, 0.0)
    assert adapter.steady.error_text
    assert adapter.steady.lost > 100
    cycles(300)
    assert 3 <= adapter.tries - 1 <= 4  # once a second
    assert "'desk'" in adapter.steady.error_text
    adapter.plugged_in = True
    cycles(150)
    assert adapter.steady.error_text == ""
    assert not robot.controller.watchdog_expired
    assert min(robot.wheel_speeds) > 0.1
