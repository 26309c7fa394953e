"""The folder of one OSCORE context, held open: nobody else uses it, and nobody can put another one in its place."""

import fcntl
import json
import os
from pathlib import Path

from hal.errors import UserError

UNKNOWN = "unknown"
"""Replay window as it is stored: the other side has to prove that it is fresh (RFC 8613, B.1.2)."""

SETTINGS = "settings.json"
PAIRED_AT = "paired-at"
"""Key in the settings of both sides: time of the pairing in seconds since 1970."""
SEQUENCE = "sequence.json"
SECRET = "secret.json"
_LOCK = "lock"
_UNBORN = ".sequence.unborn"


class CredentialsError(UserError):
    """A pairing is missing, damaged, in use by another program, or not allowed."""


class ContextFolder:
    """A folder that is locked until `release`, or until the process is gone.

    It is held by its file descriptor, not by its name: where a pairing was renewed meanwhile, what the old one still
    writes must not get into the new one, whose key it would break.
    """

    def __init__(self, path: Path) -> None:
        """Take the lock, the same as aiocoap takes, so that its own tools respect it. Raises CredentialsError."""
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
            # aiocoap's own tools unlink the file when they are done: a lock on what is gone keeps nobody out.
            if not os.path.samestat(os.fstat(self._lock), os.stat(_LOCK, dir_fd=self._folder)):
                raise BlockingIOError
        except OSError as error:
            self.release()
            raise CredentialsError(
                "another program uses this pairing", where=path, do="end that one, or make another: kurt2rt pair NAME"
            ) from error

    def still_there(self) -> bool:
        """Whether the folder still stands where it stood when it was opened."""
        try:
            return os.path.samestat(self.path.stat(), os.fstat(self._folder))
        except OSError:
            return False

    def write_sequence(self, next_to_send: int) -> None:
        """Store the next sequence number; durable when this returns. Raises OSError."""
        image = json.dumps({"next-to-send": next_to_send, "received": UNKNOWN}).encode()
        flags = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_CLOEXEC
        with open(os.open(_UNBORN, flags, 0o600, dir_fd=self._folder), "wb") as file:  # noqa: PTH123 - a descriptor
            file.write(image)
            file.flush()
            os.fsync(file.fileno())
        os.replace(_UNBORN, SEQUENCE, src_dir_fd=self._folder, dst_dir_fd=self._folder)
        # Without this a power cut may bring the old file back, and numbers would be used a second time.
        os.fsync(self._folder)

    def release(self) -> None:
        """Let go of folder and lock."""
        os.close(self._lock)
        os.close(self._folder)
