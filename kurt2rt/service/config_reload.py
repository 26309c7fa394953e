"""Settings that are read anew while the robot runs."""

import asyncio
import time
from collections.abc import Callable

import anyio.to_thread

from hal.settings import SettingsError
from kurt2rt.service.settings import ServiceSettings, reloaded_settings
from kurt2rt.service.systemd.notifier import Notifier

Tell = Callable[[str], None]
"""Takes a line for the log; may not wait."""


class ConfigReloader:
    """Reads the settings when it is asked to; takes what may change, and says of the rest that it waits for a start."""

    def __init__(
        self, read: Callable[[], ServiceSettings], current: ServiceSettings, notifier: Notifier, tell: Tell
    ) -> None:
        """`read`: as at the start; it may wait for the disk. Raises SettingsError, OSError, which are told."""
        self._read = read
        self._current = current
        self._notifier = notifier
        self._log = tell
        self._requested = False
        self._wake: Callable[[], object] | None = None

    def request(self) -> None:
        """Read the settings soon; from any thread."""
        self._requested = True
        if self._wake is not None:
            self._wake()

    async def serve(self, take: Callable[[ServiceSettings], None]) -> None:
        """Read whenever it was asked for, before too, until it is cancelled. `take` is called in the loop."""
        loop, awake = asyncio.get_running_loop(), asyncio.Event()
        self._wake = lambda: loop.call_soon_threadsafe(awake.set)
        try:
            while True:
                awake.clear()
                if self._requested:
                    self._requested = False
                    await self._reload(take)
                await awake.wait()
        finally:
            self._wake = None

    async def _reload(self, take: Callable[[ServiceSettings], None]) -> None:
        self._notifier.reloading(time.monotonic_ns() // 1000)
        try:
            reloaded = reloaded_settings(self._current, await anyio.to_thread.run_sync(self._read))
        except (SettingsError, OSError) as error:
            self._log(f"settings stay as they were: {error}")
        else:
            self._current = reloaded.settings
            take(reloaded.settings)
            if reloaded.applied:
                self._log(f"settings taken: {', '.join(reloaded.applied)}")
            if reloaded.postponed:
                self._log(f"settings for the next start, not for a robot that runs: {', '.join(reloaded.postponed)}")
            if not reloaded.applied and not reloaded.postponed:
                self._log("settings are as they were")
        self._notifier.ready()
