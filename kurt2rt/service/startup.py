"""Start of the service: the robot stands until bus, disk and network are there, in any order."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from pathlib import Path

import anyio
import anyio.to_thread

from config.errors import UserError
from hal.bus import BusError
from kurt2rt.channel.protocol.schema import ChannelError
from kurt2rt.channel.security.context_folder import CredentialsError
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from kurt2rt.platform.durable_files import make_private_folder
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.service.systemd.notifier import Notifier

RETRY_S = 1.0
"""Time between two checks of a missing dependency, in s."""
HOLD_S = 0.05
"""Time between two brake commands while the robot waits, in s; its controller stops by itself after 0.2 s."""


class StartError(UserError):
    """Folder of the program, such as the one of the knowledge, that is missing; the start waits for it."""


_WAITED_FOR = (StartError, BusError, KnowledgeError, ChannelError, CredentialsError, RecordingError, OSError)
"""Errors of a check that is tried again."""


class DependencyName(StrEnum):
    """Thing that the start of the robot program waits for, by its name in messages."""

    BUS = "bus"
    KNOWLEDGE = "knowledge"
    KEYS = "teachers' keys"
    NETWORK = "network"
    RECORDINGS = "recordings"


@dataclass(frozen=True, slots=True)
class Dependency:
    """Thing that the program waits for at its start, and the check whether it is there."""

    name: DependencyName
    check: Callable[[], object]
    """Opens the dependency, or raises what is missing. Called in a thread, again and again."""


class StartupGate:
    """Gate that waits for all dependencies at once; meanwhile the robot is braked and the service manager pinged."""

    def __init__(
        self,
        dependencies: Sequence[Dependency],
        notifier: Notifier,
        log: Callable[[str], None],
        hold: Callable[[], None],
        retry_s: float = RETRY_S,
    ) -> None:
        """Check nothing yet.

        Args:
            dependencies: what has to be there.
            notifier: gets pings and the status.
            log: gets a line if the reason changes; called in the loop.
            hold: brakes the robot if it is there; called in the loop.
            retry_s: time between two checks of a missing dependency, in s.
        """
        self._dependencies = dependencies
        self._notifier = notifier
        self._log = log
        self._hold = hold
        self._retry_s = retry_s
        self.missing: dict[DependencyName, str] = {each.name: "" for each in dependencies}
        """Error of each missing dependency, in words; empty until its first check is over."""
        self._available = {each.name: anyio.Event() for each in dependencies}

    async def wait_for(self, name: DependencyName) -> None:
        """Wait until one dependency is there; `wait_for_all`, which checks it, must run meanwhile."""
        await self._available[name].wait()

    async def wait_for_all(self) -> None:
        """Check all dependencies again and again, and return as soon as each is there.

        Raises the errors of a check that waiting does not cure, such as knowledge of another task, in an exception
        group.
        """
        async with anyio.create_task_group() as standing:
            standing.start_soon(self._hold_still)
            async with anyio.create_task_group() as looking:
                for dependency in self._dependencies:
                    looking.start_soon(self._check, dependency)
            standing.cancel_scope.cancel()

    async def _check(self, dependency: Dependency) -> None:
        while True:
            try:
                await anyio.to_thread.run_sync(dependency.check, abandon_on_cancel=True)
            except _WAITED_FOR as error:
                self._report_missing(dependency.name, str(error))
            else:
                break
            await anyio.sleep(self._retry_s)
        if self.missing.pop(dependency.name):
            self._log(f"{dependency.name} is there")
        self._available[dependency.name].set()
        self._publish_status()

    def _report_missing(self, name: DependencyName, says: str) -> None:
        if self.missing[name] != says:
            self.missing[name] = says
            self._log(startup_text({name: says}))
        self._publish_status()

    def _publish_status(self) -> None:
        self._notifier.status(startup_text(self.missing))

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
    """Make a folder with a relative path; require one with an absolute path, whose disk may be mounted later.

    A new folder at a mount point would hide the knowledge on the disk. Raises StartError if the folder is missing or
    cannot be made.
    """
    if not folder.is_absolute():
        make_private_folder(folder)
    elif not folder.is_dir():
        raise StartError(f"{folder} is not there", do="it comes with its disk, or make it")


def startup_text(missing: Mapping[DependencyName, str]) -> str:
    """Return the line for a start with these missing dependencies; those without a known error are left out."""
    known = {name: says for name, says in missing.items() if says}
    return f"stands and waits for {missing_text(known)}" if known else "starts"


def missing_text(missing: Mapping[DependencyName, str]) -> str:
    """Return the dependencies with a known error in a line; without any, the names of all."""
    known = [f"{name}: {says}" for name, says in missing.items() if says]
    return "; ".join(known or missing)
