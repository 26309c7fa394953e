"""Robot's side of all pairings while the robot runs."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import anyio.to_thread
from aiocoap import oscore

from kurt2rt.channel.security.context_folder import SECRET, CredentialsError
from kurt2rt.channel.security.oscore_context import OscoreContext
from kurt2rt.channel.security.pairing import OF_THIS_MACHINE, RESERVED, USED, pairing_names

_USED_EVERY_S = 60.0

_Identity = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class PairingChange:
    """Devices whose pairings `Teachers.refresh` added and removed, by name; a renewed one is in both."""

    added: tuple[str, ...]
    removed: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Held:
    identity: _Identity
    context: OscoreContext
    seen: tuple[int | None, int | None]
    used_s: float
    """Time when the last use was noted on the disk, of the monotonic clock in seconds."""


@dataclass(frozen=True, slots=True)
class _Scan:
    held: dict[str, _Held]
    removed: dict[str, OscoreContext]
    added: tuple[str, ...]
    trouble: tuple[str, ...]


class Teachers:
    """Keys of all paired devices, from one `teachers` folder, which stays locked until `close`.

    A pairing that cannot be opened is skipped and reported by `trouble`. Use it from one thread.
    """

    def __init__(self, folder: Path, *, now: Callable[[], float] = time.monotonic) -> None:
        """Open every pairing; this waits for the disk. Raises CredentialsError if the folder cannot be read."""
        self._folder = folder
        self._now = now
        self._held: Mapping[str, _Held] = {}
        self._by_id: dict[bytes, OscoreContext] = {}
        self._trouble: tuple[str, ...] = ()
        pairing_names(folder)  # an unreadable folder is an error here; later it is reported by `trouble`
        self._apply(self._scan({}))

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the devices whose requests are accepted."""
        return tuple(sorted(self._held))

    @property
    def only_local(self) -> bool:
        """True if all pairings are this machine's own, so that loopback suffices."""
        return OF_THIS_MACHINE.issuperset(self._held)

    @property
    def trouble(self) -> tuple[str, ...]:
        """Lines on the pairings that could not be opened, or whose state cannot be stored."""
        return (*self._trouble, *(held.context.trouble for held in self._held.values() if held.context.trouble))

    def find(self, unprotected: Mapping[int, bytes]) -> OscoreContext:
        """Return the context for aiocoap's OSCORE header of a request. Raises KeyError for an unknown id."""
        context = self._by_id[unprotected[oscore.COSE_KID]]
        if unprotected.get(oscore.COSE_KID_CONTEXT) != context.id_context:
            raise KeyError(oscore.COSE_KID_CONTEXT)
        return context

    async def refresh(self) -> PairingChange:
        """Apply new, renewed and revoked pairings of the folder. Call it once a second, one call at a time.

        A thread waits for the disk. A removed context sends nothing more. Faults of the folder go to `trouble`.
        """
        scan = await anyio.to_thread.run_sync(self._scan, dict(self._held))
        self._apply(scan)
        if scan.removed:
            await anyio.to_thread.run_sync(_abandon, scan.removed)
        return PairingChange(scan.added, tuple(scan.removed))

    def close(self) -> None:
        """Store all states and release the locks; this waits for the disk. Raises the first CredentialsError last."""
        errors = []
        for held in self._held.values():
            try:
                held.context.close()
            except CredentialsError as error:
                errors.append(error)
        self._held, self._by_id = {}, {}
        if errors:
            raise errors[0]

    def _apply(self, scan: _Scan) -> None:
        self._held, self._trouble = scan.held, scan.trouble
        self._by_id = {held.context.recipient_id: held.context for held in scan.held.values()}

    def _scan(self, held: dict[str, _Held]) -> _Scan:
        trouble: list[str] = []
        try:
            names = pairing_names(self._folder)
        except CredentialsError as error:
            return _Scan(held, {}, (), (str(error),))
        added: list[str] = []
        still: dict[str, _Held] = {}
        for name in names:
            if name in RESERVED:
                trouble.append(
                    f"{self._folder / name}: is not let in, for {name} is the name of the robot's own critic; "
                    f"kurt2rt pair {name} --revoke, then pair the device under another one"
                )
                continue
            mine = held.get(name)
            try:
                identity = _identity(self._folder / name)
                if mine is not None and identity == mine.identity:
                    still[name] = self._note_use(name, mine)
                elif identity is not None:
                    context = OscoreContext(self._folder / name)
                    still[name] = _Held(identity, context, context.seen, float("-inf"))
                    added.append(name)
            except CredentialsError as error:
                trouble.append(str(error))
            except OSError as error:
                # A failing disk must not disconnect the teacher, who may want to stop the robot.
                trouble.append(f"{self._folder / name}: cannot be looked at ({error}); look at its disk")
                if mine is not None:
                    still[name] = mine
        removed = {
            name: mine.context
            for name, mine in held.items()
            if name not in still or still[name].context is not mine.context
        }
        return _Scan(still, removed, tuple(added), tuple(trouble))

    def _note_use(self, name: str, held: _Held) -> _Held:
        seen, now = held.context.seen, self._now()
        if seen == held.seen or now - held.used_s < _USED_EVERY_S:
            return held
        (self._folder / name / USED).touch(mode=0o600)
        return replace(held, seen=seen, used_s=now)


def _identity(folder: Path) -> _Identity | None:
    """Return a value that changes when a pairing is renewed or restored; None if it is gone. Raises OSError."""
    try:
        of_folder, of_secret = folder.stat(), (folder / SECRET).stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return of_folder.st_dev, of_folder.st_ino, of_secret.st_ino, of_secret.st_mtime_ns


def _abandon(contexts: Mapping[str, OscoreContext]) -> None:
    for context in contexts.values():
        context.abandon()
