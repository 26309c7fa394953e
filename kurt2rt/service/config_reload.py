"""Reload of the settings while the robot runs."""

import asyncio
import time
from collections.abc import Callable

import anyio.to_thread

from hal.settings import SettingsError
from kurt2rt.service.settings import ServiceSettings, reloaded_settings
from kurt2rt.service.systemd.notifier import Notifier

Log = Callable[[str], None]
"""Gets a line for the log; may not wait."""


class ConfigReloader:
    """Reads the settings on request, applies those that may change, and logs which wait for the next start."""

    def __init__(
        self, read: Callable[[], ServiceSettings], current: ServiceSettings, notifier: Notifier, log: Log
    ) -> None:
        """Keep the reader and the present settings.

        Args:
            read: reads the settings as at the start, in a thread; its SettingsError and OSError are logged.
            current: settings of the running service.
            notifier: gets the begin and the end of each reload.
            log: gets a line with the result.
        """
        self._read = read
        self._current = current
        self._notifier = notifier
        self._log = log
        self._requested = False
        self._wake: Callable[[], object] | None = None

    def request(self) -> None:
        """Request a reload; may be called from any thread."""
        self._requested = True
        if self._wake is not None:
            self._wake()

    async def serve(self, apply: Callable[[ServiceSettings], None]) -> None:
        """Reload after each request, earlier ones too, until cancelled; call `apply` with the result, in the loop."""
        loop, awake = asyncio.get_running_loop(), asyncio.Event()
        self._wake = lambda: loop.call_soon_threadsafe(awake.set)
        try:
            while True:
                awake.clear()
                if self._requested:
                    self._requested = False
                    await self._reload(apply)
                await awake.wait()
        finally:
            self._wake = None

    async def _reload(self, apply: Callable[[ServiceSettings], None]) -> None:
        self._notifier.reloading(time.monotonic_ns() // 1000)
        try:
            reloaded = reloaded_settings(self._current, await anyio.to_thread.run_sync(self._read))
        except (SettingsError, OSError) as error:
            self._log(f"settings stay as they were: {error}")
        else:
            self._current = reloaded.settings
            apply(reloaded.settings)
            if reloaded.applied:
                self._log(f"settings taken: {', '.join(reloaded.applied)}")
            if reloaded.postponed:
                self._log(f"settings for the next start, not for a robot that runs: {', '.join(reloaded.postponed)}")
            if not reloaded.applied and not reloaded.postponed:
                self._log("settings are as they were")
        self._notifier.ready()
