"""A second teacher who drives by hand over a link that may fail."""

import random

from kurt2rt.channel.server.request_handler import RequestHandler
from kurt2rt.core.teaching.commands import Drive
from kurt2rt.core.teaching.message_fields import HIGHEST_SPEED_M_S
from kurt2rt.teacher.client.manual_drive import BEAT_S
from tests.stories.device import Device
from tests.stories.fault import FaultInjection

DRIVER = "ann"
_SPEEDS_M_S = (0.3, 0.28)
_SWERVES_EVERY_S = 0.25


class Hand(Device):
    """Device of a teacher who presses to drive. wrong: well-formed and too fast; the others are the link's."""

    def __init__(
        self, device: Device, handler: RequestHandler, boot: bytes, injection: FaultInjection, chance: random.Random
    ) -> None:
        """`device`: of the first teacher, which is judged and awaited with this one. `boot`: of the program."""
        super().__init__(injection, chance, DRIVER, "teacher_link")
        self.judge, self._tasks = device.judge, device._tasks
        self._handler, self._boot, self._injection = handler, boot, injection
        self._press_id = 0
        self._presses = False

    def press(self) -> None:
        """Begin to press, or let go and press again."""
        self._press_id += 1
        if not self._presses:
            self._presses = True
            self._beat()

    def press_again(self) -> None:
        """Let go and press again, if the finger is down."""
        self._press_id += self._presses

    def let_go(self) -> None:
        """Send no more messages."""
        self._presses = False

    def _beat(self) -> None:
        if self._presses and self._handler is not None:
            self._time.at(self._time.now_s() + BEAT_S, self._beat)
            self.send(Drive("", self._handler.tick, self._press_id, *self._speeds_m_s()))

    def _speeds_m_s(self) -> tuple[float, float]:
        fault = self._injection.acting_on("teacher_link")
        if fault is None or fault.kind != "wrong":
            return _SPEEDS_M_S
        swerves = int((self._time.now_s() - fault.begin_s) / _SWERVES_EVERY_S)
        fast, slow = HIGHEST_SPEED_M_S, HIGHEST_SPEED_M_S / 2
        return (slow, fast) if swerves % 2 == 0 else (fast, slow)
