"""Folder of one OSCORE context, locked and held by its descriptor."""

import fcntl
import json
import os
from pathlib import Path

from config.errors import UserError

UNKNOWN = "unknown"
"""Stored replay window, by which the other side has to prove freshness (RFC 8613, B.1.2)."""

SETTINGS = "settings.json"
PAIRED_AT = "paired-at"
"""Key in the settings of both sides: time of the pairing in seconds since 1970."""
SEQUENCE = "sequence.json"
SECRET = "secret.json"
_LOCK = "lock"
_UNFINISHED = ".sequence.unborn"


class CredentialsError(UserError):
    """Pairing that is missing, damaged, in use by another program, or not allowed."""


class ContextFolder:
    """Folder that is locked until `close`, or until the process ends.

    It is held by its file descriptor: after a renewal, late writes of the old pairing must not reach the new one, whose
    key they would break.
    """

    def __init__(self, path: Path) -> None:
        """Take the lock of aiocoap, so that its own tools respect it.

        Raises CredentialsError if the folder is missing, cannot be locked, or is in use; BlockingIOError never leaves.
        """
        self.path = path
        name = path.name
        try:
            self._folder = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_CLOEXEC)
        except OSError as error:
            raise CredentialsError(
                f"there is no pairing to open ({error.strerror})", where=path, do=f"make one: kurt2rt pair {name}"
            ) from error
        try:
            self._lock = os.open(_LOCK, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600, dir_fd=self._folder)
        except OSError as error:
            os.close(self._folder)
            raise CredentialsError(
                f"cannot be locked ({error.strerror})", where=path, do="give write permission for this folder"
            ) from error
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            # aiocoap's tools unlink the file at their end: a lock on an unlinked file excludes no one.
            if not os.path.samestat(os.fstat(self._lock), os.stat(_LOCK, dir_fd=self._folder)):
                raise BlockingIOError
        except OSError as error:
            self.close()
            raise CredentialsError(
                "another program uses this pairing", where=path, do="end that one, or make another: kurt2rt pair NAME"
            ) from error

    def still_there(self) -> bool:
        """Return whether the path still names the folder that was opened."""
        try:
            return os.path.samestat(self.path.stat(), os.fstat(self._folder))
        except OSError:
            return False

    def write_sequence(self, next_to_send: int) -> None:
        """Store the next sequence number; durable when this returns. Raises OSError."""
        image = json.dumps({"next-to-send": next_to_send, "received": UNKNOWN}).encode()
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
        with open(os.open(_UNFINISHED, flags, 0o600, dir_fd=self._folder), "wb") as file:  # noqa: PTH123 - a descriptor
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        os.replace(_UNFINISHED, SEQUENCE, src_dir_fd=self._folder, dst_dir_fd=self._folder)
        # Without this a power cut may restore the old file, and numbers would be used twice.
        os.fsync(self._folder)

    def close(self) -> None:
        """Close the folder and release the lock; call it once."""
        os.close(self._lock)
        os.close(self._folder)
