"""The robot's side of all pairings while the robot runs."""

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
    """What `Teachers.refresh` found, by name; a renewed pairing is in both."""

    came: tuple[str, ...]
    gone: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class _Held:
    identity: _Identity
    context: OscoreContext
    seen: tuple[int | None, int | None]
    used_s: float
    """When the time of last use was noted."""


@dataclass(frozen=True, slots=True)
class _Look:
    held: dict[str, _Held]
    gone: dict[str, OscoreContext]
    came: tuple[str, ...]
    trouble: tuple[str, ...]


class Teachers:
    """All contexts of one `teachers` folder, locked until `close`.

    A pairing that cannot be opened does not keep the others out; `trouble` tells of it. Used from one thread.
    """

    def __init__(self, folder: Path, *, now: Callable[[], float] = time.monotonic) -> None:
        """Open every pairing; this waits for the disk. Raises CredentialsError when the folder cannot be read."""
        self._folder = folder
        self._now = now
        self._held: Mapping[str, _Held] = {}
        self._by_id: dict[bytes, OscoreContext] = {}
        self._trouble: tuple[str, ...] = ()
        pairing_names(folder)  # afterwards a folder that cannot be read is told of; now it is an error
        self._take(self._look({}))

    @property
    def names(self) -> tuple[str, ...]:
        """Whose requests are accepted."""
        return tuple(sorted(self._held))

    @property
    def only_local(self) -> bool:
        """Whether nobody was paired, so that nothing beyond this machine needs to be listened to."""
        return OF_THIS_MACHINE.issuperset(self._held)

    @property
    def trouble(self) -> tuple[str, ...]:
        """A line for each pairing that could not be opened, or whose state cannot be stored."""
        return (*self._trouble, *(held.context.trouble for held in self._held.values() if held.context.trouble))

    def find(self, unprotected: Mapping[int, bytes]) -> OscoreContext:
        """The context for aiocoap's OSCORE header of a request. Raises KeyError when nobody has that id."""
        context = self._by_id[unprotected[oscore.COSE_KID]]
        if unprotected.get(oscore.COSE_KID_CONTEXT) != context.id_context:
            raise KeyError(oscore.COSE_KID_CONTEXT)
        return context

    async def refresh(self) -> PairingChange:
        """Look who was paired, renewed or revoked since; once a second is meant, one call at a time.

        All that waits for the disk is done in a thread. A context that is gone sends nothing more. Never raises for the
        state of the folder: `trouble` tells.
        """
        look = await anyio.to_thread.run_sync(self._look, dict(self._held))
        self._take(look)
        if look.gone:
            await anyio.to_thread.run_sync(_abandon, look.gone)
        return PairingChange(look.came, tuple(look.gone))

    def close(self) -> None:
        """Store all states and release the locks; waits for the disk. Raises the first CredentialsError, after all."""
        errors = []
        for held in self._held.values():
            try:
                held.context.close()
            except CredentialsError as error:
                errors.append(error)
        self._held, self._by_id = {}, {}
        if errors:
            raise errors[0]

    def _take(self, look: _Look) -> None:
        self._held, self._trouble = look.held, look.trouble
        self._by_id = {held.context.recipient_id: held.context for held in look.held.values()}

    def _look(self, held: dict[str, _Held]) -> _Look:
        trouble: list[str] = []
        try:
            names = pairing_names(self._folder)
        except CredentialsError as error:
            return _Look(held, {}, (), (str(error),))
        came: list[str] = []
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
                    still[name] = self._noted(name, mine)
                elif identity is not None:
                    context = OscoreContext(self._folder / name)
                    still[name] = _Held(identity, context, context.seen, float("-inf"))
                    came.append(name)
            except CredentialsError as error:
                trouble.append(str(error))
            except OSError as error:
                # A disk that fails is no reason to lose the teacher, who may want to say stop.
                trouble.append(f"{self._folder / name}: cannot be looked at ({error}); look at its disk")
                if mine is not None:
                    still[name] = mine
        gone = {
            name: mine.context
            for name, mine in held.items()
            if name not in still or still[name].context is not mine.context
        }
        return _Look(still, gone, tuple(came), tuple(trouble))

    def _noted(self, name: str, held: _Held) -> _Held:
        seen, now = held.context.seen, self._now()
        if seen == held.seen or now - held.used_s < _USED_EVERY_S:
            return held
        (self._folder / name / USED).touch(mode=0o600)
        return replace(held, seen=seen, used_s=now)


def _identity(folder: Path) -> _Identity | None:
    """What changes when a pairing is renewed or put back; None: it is no pairing any more. Raises OSError."""
    try:
        of_folder, of_secret = folder.stat(), (folder / SECRET).stat()
    except (FileNotFoundError, NotADirectoryError):
        return None
    return of_folder.st_dev, of_folder.st_ino, of_secret.st_ino, of_secret.st_mtime_ns


def _abandon(contexts: Mapping[str, OscoreContext]) -> None:
    for context in contexts.values():
        context.abandon()
