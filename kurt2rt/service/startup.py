"""The start in whatever order bus, disk and network come: until all of them are there, the robot stands."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import anyio
import anyio.to_thread

from hal.bus import BusError
from hal.errors import UserError
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_private_folder
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.service.systemd.notifier import Notifier

RETRY_S = 1.0
"""Between two looks at what is not there."""
HOLD_S = 0.05
"""Between two brakes of a robot that waits; its controller forgets after 0.2 s."""


class StartError(UserError):
    """Something that the program needs is not there yet."""


_COMES_LATER = (StartError, BusError, KnowledgeError, ChannelError, CredentialsError, RecordingError, OSError)


@dataclass(frozen=True, slots=True)
class Dependency:
    """One thing that the program cannot do without."""

    name: str
    check: Callable[[], object]
    """Takes it, or raises one line that says what is missing. Called outside the loop, again and again."""


class StartupGate:
    """Waits for all needs at once. Meanwhile it has the robot stand, pings, and tells what it waits for."""

    def __init__(
        self,
        needs: Sequence[Dependency],
        notifier: Notifier,
        tell: Callable[[str], None],
        hold: Callable[[], None],
        again_s: float = RETRY_S,
    ) -> None:
        """`tell`: a line for the log. `hold` has the robot stand, if it is there. Both are called in the loop."""
        self._dependencies = needs
        self._notifier = notifier
        self._log = tell
        self._hold = hold
        self._retry_s = again_s
        self._missing = {each.name: "" for each in needs}
        self._available = {each.name: anyio.Event() for each in needs}

    @property
    def missing(self) -> tuple[str, ...]:
        """What is not there, each with the reason once it is known."""
        return tuple(f"{name}: {why}" if why else name for name, why in self._missing.items())

    @property
    def waits_for(self) -> str:
        """What is known to be missing and why, in a line; of what is only being looked for, the names."""
        return "; ".join([each for each in self.missing if ": " in each] or self.missing)

    async def wait_for(self, name: str) -> None:
        """Return when one of the needs is there."""
        await self._available[name].wait()

    async def wait_for_all(self) -> None:
        """Return when all is there. Raises what no waiting mends."""
        async with anyio.create_task_group() as standing:
            standing.start_soon(self._hold_still)
            async with anyio.create_task_group() as looking:
                for need in self._dependencies:
                    looking.start_soon(self._check, need)
            standing.cancel_scope.cancel()

    async def _check(self, need: Dependency) -> None:
        while True:
            try:
                await anyio.to_thread.run_sync(need.check, abandon_on_cancel=True)
            except _COMES_LATER as error:
                self._report_missing(need.name, str(error))
            else:
                break
            await anyio.sleep(self._retry_s)
        if self._missing.pop(need.name):
            self._log(f"{need.name} is there")
        self._available[need.name].set()
        self._publish_status()

    def _report_missing(self, name: str, why: str) -> None:
        if self._missing[name] != why:
            self._missing[name] = why
            self._log(f"stands and waits for {name}: {why}")
        self._publish_status()

    def _publish_status(self) -> None:
        known = [each for each in self.missing if ": " in each]
        self._notifier.status(f"stands and waits for {'; '.join(known)}" if known else "starts")

    async def _hold_still(self) -> None:
        pings_every_s = None if self._notifier.watchdog_s is None else self._notifier.watchdog_s / 2
        pinged_s = -float("inf")
        while True:
            self._hold()
            if pings_every_s is not None and time.monotonic() - pinged_s >= pings_every_s:
                pinged_s = time.monotonic()
                self._notifier.ping()
            await anyio.sleep(HOLD_S)


def require_folder(folder: Path) -> None:
    """A folder of the program's own is made; one elsewhere has to be there: its disk may come late. Raises StartError.

    To begin anew on the place where a disk is going to be mounted would hide all that was taught.
    """
    if not folder.is_absolute():
        make_private_folder(folder)
    elif not folder.is_dir():
        raise StartError(f"{folder} is not there", do="it comes with its disk, or make it")
