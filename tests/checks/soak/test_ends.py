"""Ends whose ways may fail behave as every bus does while they do not."""

from collections.abc import Iterator
from typing import ClassVar

import pytest

from hal.bus import CanBus
from simbridge.faults.cable import Cable
from simbridge.faults.event_scheduler import EventScheduler
from simbridge.faults.switchable_interface import Links, SwitchableInterface
from tests.hal.bus_conformance import Behind, ErrorFrameConformance, Join, joining


class TestChangingEnd(ErrorFrameConformance):
    receives_own_frames: ClassVar[bool] = True
    behind: ClassVar[Behind] = Behind.NEWEST_ARE_LOST

    @pytest.fixture
    def join(self) -> Iterator[Join]:
        time = EventScheduler()
        cable = Cable(time.now_s)
        with joining(lambda: CanBus("cable", lambda _: SwitchableInterface(cable.open(), Links(), time.now_s))) as join:
            yield join
