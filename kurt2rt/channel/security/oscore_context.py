"""One side of a pairing in use: keys, sequence numbers, replay window. The event loop does not wait for a disk.

A folder may be restored from a backup, which knows neither the numbers used since nor the requests that came. So a
start takes no number below one per millisecond since the pairing, five times the most that a device uses. It begins
with an unknown replay window, so that the other side has to prove freshness (RFC 8613, B.1.2).
"""

import json
import secrets
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from aiocoap import oscore

from kurt2rt.channel.security.context_folder import PAIRED_AT, SEQUENCE, SETTINGS, ContextFolder, CredentialsError

CHUNK = 10_000
"""Sequence numbers reserved at once: three minutes of states and drive commands. A crash wastes at most two chunks of
the 2^40 that a pairing has."""
FIRST_CHUNK = 1000
"""First chunk, doubled each time up to CHUNK: a program that crashes once a second stays behind its clock."""
NUMBERS_PER_S = 1000
LAST_FLOOR = 2**39
"""Highest number that time alone sets, 17 years: a clock decades ahead leaves half of all numbers."""


class OscoreContext(oscore.FilesystemSecurityContext):  # type: ignore[misc]  # Any
    """Security context in a folder, like aiocoap's, with four differences.

    Each start jumps ahead by the time since the pairing, and trusts no replay window. Numbers are reserved ahead in a
    thread, so `protect` stores in place only if the disk took longer than half a chunk lasts. Writes go through a
    descriptor of the folder, so a renewed pairing in its place stays untouched. It ends with `close`, not with the last
    reference.

    The thread is a plain one, started once per chunk, because the callers of `protect` cannot await. Call all methods
    from one thread at a time.
    """

    sender_sequence_number: int
    recipient_replay_window: Any

    def __init__(
        self, folder: Path, name: str | None = None, *, chunk: int = CHUNK, now: Callable[[], float] = time.time
    ) -> None:
        """Take the lock, load, and reserve the first chunk; this waits for the disk.

        Raises CredentialsError if the folder is missing, damaged, or in use by another program.

        Args:
            folder: One side of a pairing.
            name: Teacher that this context authenticates. None: the folder's name.
            chunk: Most sequence numbers to reserve at once.
            now: Wall clock in seconds since 1970; it may be set back, because the stored number counts too.
        """
        # aiocoap's own constructor is not called: its lock is bound to a thread, and it stores in the event loop.
        self.folder = ContextFolder(folder)
        self.basedir = str(folder)
        self.lockfile = None
        self.name = folder.name if name is None else name
        self.authenticated_claims = [self.name]
        self.trouble = ""
        self.echo_recovery = secrets.token_bytes(8)
        self._now = now
        self._longest_chunk = chunk
        self._chunk = min(chunk, FIRST_CHUNK)
        self._reserve_below = self._chunk // 2
        self._storing = threading.Lock()
        self._reserver: threading.Thread | None = None
        self._closed = False
        try:
            self._load_checked()
            self.sequence_number_persisted = self.sender_sequence_number
            self.replay_window_persisted = False
            self._reserve()
        except OSError as error:
            self.folder.close()
            raise CredentialsError(
                f"cannot be read and written ({error})", where=folder, do="give permission for it, and room on its disk"
            ) from error
        except CredentialsError:
            self.folder.close()
            raise

    @property
    def closed(self) -> bool:
        """True after `close` or `abandon`; it protects no messages then."""
        return self._closed

    @property
    def seen(self) -> tuple[int | None, int | None]:
        """Lowest number and bits of the replay window, which change with each authenticated request.

        Both are None until the first request after a restart has proved to be new.
        """
        window: Any = self.recipient_replay_window
        return window._index, window._bitfield

    def new_sequence_number(self) -> int:
        """Return an unused sequence number. Raises aiocoap.oscore.ContextUnavailable if there is none."""
        if self._closed:
            raise oscore.ContextUnavailable(f"{self.folder.path}: this pairing is closed or revoked")
        number: int = super().new_sequence_number()
        return number

    def post_seqnoincrease(self) -> None:
        """Reserve further numbers; aiocoap calls this for each number before its use.

        Raises aiocoap.oscore.ContextUnavailable if the disk takes no reservation.
        """
        if self.sender_sequence_number > self.sequence_number_persisted:
            try:
                self._reserve()
            except OSError as error:
                raise oscore.ContextUnavailable(
                    f"{self.folder.path}: no sequence number can be reserved ({error})"
                ) from error
        elif self.sequence_number_persisted - self.sender_sequence_number < self._reserve_below and (
            self._reserver is None or not self._reserver.is_alive()
        ):
            # A daemon, because a hanging disk must not keep the program alive; a half-written file is never renamed.
            self._reserver = threading.Thread(target=self._reserve_in_thread, name=f"oscore {self.name}", daemon=True)
            self._reserver.start()

    def close(self) -> None:
        """Store the exact number and release the lock; this waits for the disk.

        Raises CredentialsError if that fails; the reservation stands then, which wastes numbers but uses none twice.
        """
        if self._closed:
            return
        self._closed = True
        if self._reserver is not None:
            self._reserver.join()
        try:
            if self.folder.still_there():
                self.folder.write_sequence(self.sender_sequence_number)
        except OSError as error:
            raise CredentialsError(
                f"its state cannot be stored ({error})",
                where=self.folder.path,
                do="the pairing goes on with other numbers, but look at its disk",
            ) from error
        finally:
            self.folder.close()

    def abandon(self) -> None:
        """Release the lock and store nothing: the pairing was revoked or renewed."""
        if self._closed:
            return
        self._closed = True
        if self._reserver is not None:
            self._reserver.join()
        self.folder.close()

    def __del__(self) -> None:
        """Do nothing, because aiocoap's method would store. The lock of an unclosed context ends with the process."""

    def _load_checked(self) -> None:
        what_to_do = f"pair the device again: kurt2rt pair {self.name} --renew"
        # aiocoap would begin at 0 again, and a number used twice gives the key away.
        if not (self.folder.path / SEQUENCE).exists():
            raise CredentialsError(f"{SEQUENCE} is missing", where=self.folder.path, do=what_to_do)
        try:
            self._load()
            paired_s = self._paired_s()
            sound = all(number is None or number >= 0 for number in (self.sender_sequence_number, *self.seen))
        except (KeyError, ValueError, TypeError, AttributeError) as error:
            raise CredentialsError(
                f"the pairing is damaged ({error!r})", where=self.folder.path, do=what_to_do
            ) from error
        if not sound:
            raise CredentialsError(f"{SEQUENCE} holds a negative number", where=self.folder.path, do=what_to_do)
        if not self.folder.still_there():
            raise CredentialsError("was replaced while it was opened", where=self.folder.path, do="open it again")
        window = self.recipient_replay_window
        self.recipient_replay_window = oscore.ReplayWindow(window._size, self._replay_window_changed)
        by_time = int(min(max(0.0, self._now() - paired_s) * NUMBERS_PER_S, LAST_FLOOR))
        self.sender_sequence_number = max(self.sender_sequence_number, by_time)

    def _paired_s(self) -> float:
        """Return the time of the pairing in seconds since 1970. Raises KeyError, ValueError, OSError."""
        settings = json.loads((self.folder.path / SETTINGS).read_text(encoding="utf-8"))
        return float(settings[PAIRED_AT])

    def _reserve(self) -> None:
        # The thread and the event loop may both come here; the second one finds the work done.
        with self._storing:
            if self.sender_sequence_number + self._chunk // 2 <= self.sequence_number_persisted:
                return
            up_to = max(self.sender_sequence_number, self.sequence_number_persisted) + self._chunk
            self.folder.write_sequence(up_to)
            self.sequence_number_persisted = up_to

    def _reserve_in_thread(self) -> None:
        try:
            self._reserve()
        except OSError as error:
            # Tried again when half of the rest is used; without numbers the caller gets an error.
            self._reserve_below //= 2
            self.trouble = f"{self.folder.path}: no sequence numbers can be reserved ({error}); look at its disk"
        else:
            self._chunk = min(2 * self._chunk, self._longest_chunk)
            self._reserve_below = self._chunk // 2
            self.trouble = ""
