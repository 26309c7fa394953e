"""Ends of the link between robot and notebook, by what all links have in common."""

import random
from abc import ABC, abstractmethod
from collections.abc import Callable

from hal.bus import CanBus
from hal.guarded_robot import GuardedRobot
from simbridge.robot.wheels import Wheels
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_settings import WorldSettings
from tests.stories.fault import FaultInjection
from tests.stories.table import Fault, Target
from tests.stories.wire import Wire


class Ends(ABC):
    """Base of the ends of a link, which outlast each driver."""

    target: Target
    """Adapter or line, which may be unplugged."""
    wire: Wire
    speaks_every_s: float
    """Period of a stranger, and of a diagnosis."""

    def __init__(self, injection: FaultInjection, chance: random.Random) -> None:
        self.on_sent: Callable[[int, bytes], None] = lambda _number, _payload: None
        """Callback with number and payload of each command that the driver sends."""
        self.on_arrived: Callable[[int, bytes, float], None] = lambda _number, _payload, _at_s: None
        """Callback with number, payload and time of arrival of each command that arrives at the robot."""
        self.on_heard: Callable[[int, bytes, float], None] = lambda _id, _payload, _at_s: None
        """Callback with identifier (0 without CAN), payload and time of each message of readings for the notebook."""
        self.bus: CanBus | None = None
        """Driver's interface to CAN; None without one."""
        self._injection, self._time, self._chance = injection, injection.time, chance
        self._sent = 0

    @abstractmethod
    def simulated(self, world: WorldSettings, seed: int, wheels: Wheels) -> SimulatedRobot:
        """Return the robot at its end."""

    @abstractmethod
    def start_driver(self) -> GuardedRobot:
        """Return a new driver at the notebook's end."""

    @property
    def back_at_s(self) -> float:
        """Time at which the adapter is plugged in again; 0 if it is."""
        fault = self._injection.acting_on(self.target)
        return fault.end_s if fault is not None and fault.kind == "unplugged" else 0.0

    def begin(self, fault: Fault) -> None:
        """Do what a fault does at its beginning: a stranger or a diagnosis begins to speak."""
        if _speaks(fault):
            self._speak(fault)

    def finish(self, fault: Fault) -> None:
        """Do what a fault does at its end."""
        if _speaks(fault):
            self._say(fault, over=True)

    @abstractmethod
    def _say(self, fault: Fault, *, over: bool) -> None:
        """Say what a stranger or a diagnosis says while the fault lasts, and when it is over."""

    def _speak(self, fault: Fault) -> None:
        if fault.acts(self._time.now_s()):
            self._injection.acted.add(fault)
            self._say(fault, over=False)
            self._time.at(self._time.now_s() + self.speaks_every_s, lambda: self._speak(fault))

    def _note_sent(self, payload: bytes) -> int:
        """Report a command of the driver, and return its number."""
        self._sent += 1
        self.on_sent(self._sent, payload)
        return self._sent


def _speaks(fault: Fault) -> bool:
    return fault.target == "stranger" or fault.kind in ("stranger", "alarm")
