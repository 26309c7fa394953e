"""A copy of something that the robot has, fetched anew when it has changed there."""

from collections.abc import Awaitable, Callable
from typing import Any

import anyio

from kurt2rt.teacher.client.answer import NoAnswerError


class CachedResource:
    """What the robot says rarely: what robot it is, its world, its lessons."""

    def __init__(
        self,
        fetch: Callable[[], Awaitable[dict[str, Any]]],
        tell: Callable[[dict[str, Any]], None],
        rest_s: float = 0.3,
    ) -> None:
        """`fetch` asks the robot and may raise NoAnswerError; `tell` takes each new copy; `rest_s` lies between two."""
        self._fetch = fetch
        self._tell = tell
        self._rest_s = rest_s
        self._mark: object = None
        self._wanted = anyio.Event()
        self.copy: dict[str, Any] | None = None

    def want(self, mark: object) -> None:
        """Fetch anew unless the copy has this mark."""
        if mark != self._mark:
            self._mark = mark
            self._wanted.set()

    async def run(self) -> None:
        """Keep the copy new, for ever."""
        while True:
            await self._wanted.wait()
            self._wanted = anyio.Event()
            try:
                self.copy = await self._fetch()
            except NoAnswerError:
                self._wanted.set()  # the robot is silent or lossy: ask again
            else:
                self._tell(self.copy)
            await anyio.sleep(self._rest_s)
