"""Copy of a resource of the robot, fetched again when it has changed there."""

from collections.abc import Awaitable, Callable
from typing import Any

import anyio

from kurt2rt.teacher.client.answer import NoAnswerError


class CachedResource:
    """Copy of one resource, with the version that it was fetched for."""

    def __init__(
        self,
        fetch: Callable[[], Awaitable[dict[str, Any]]],
        publish: Callable[[dict[str, Any]], None],
        pause_s: float = 0.3,
    ) -> None:
        """`fetch` asks the robot and may raise NoAnswerError; `publish` gets each copy; `pause_s` between requests."""
        self._fetch = fetch
        self._publish = publish
        self._pause_s = pause_s
        self._version: object = None
        self._due = anyio.Event()
        self.value: dict[str, Any] | None = None

    def refresh(self, version: object) -> None:
        """Fetch the resource unless the copy has this version."""
        if version != self._version:
            self._version = version
            self._due.set()

    async def run(self) -> None:
        """Fetch the resource after each `refresh` to another version, until cancelled; retry without an answer."""
        while True:
            await self._due.wait()
            self._due = anyio.Event()
            try:
                self.value = await self._fetch()
            except NoAnswerError:
                self._due.set()  # ask again after the pause
            else:
                self._publish(self.value)
            await anyio.sleep(self._pause_s)
