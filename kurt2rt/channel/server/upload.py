"""Upload of a file, part by part, into memory."""

import hashlib

from kurt2rt.channel.protocol.limits import MOST_UPLOAD_BYTES
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode


class Upload:
    """File that is being uploaded; a newer upload replaces it."""

    def __init__(self, most_bytes: int = MOST_UPLOAD_BYTES) -> None:
        self._most_bytes = most_bytes
        self._of: tuple[str, bytes] | None = None
        self._content = bytearray()

    def add(self, device: str, upload: bytes, offset: int, part: bytes) -> int:
        """Append a part to a device's upload and return the size so far in bytes; a repeated part changes nothing.

        `upload`: id of the upload. `offset`: position of the part in bytes. Raises CommandRefusedError for a gap, too
        many bytes, or a repeated part that differs.
        """
        if self._of != (device, upload):
            if offset != 0:
                raise CommandRefusedError(RefusalCode.UPLOAD_UNKNOWN)
            self._of, self._content = (device, upload), bytearray()
        if offset > len(self._content):
            raise CommandRefusedError(RefusalCode.UPLOAD_GAP, offset=offset, size=len(self._content))
        if offset + len(part) > self._most_bytes:
            raise CommandRefusedError(RefusalCode.UPLOAD_TOO_LARGE, most_bytes=self._most_bytes)
        if self._content[offset : offset + len(part)] not in (b"", part):
            raise CommandRefusedError(RefusalCode.UPLOAD_DIFFERS, offset=offset)
        self._content[offset : offset + len(part)] = part
        return len(self._content)

    def pop(self, device: str, upload: bytes, sha256: bytes) -> bytes:
        """Return the whole file of a device's upload and drop it; `sha256` is the hash that it must have.

        Raises CommandRefusedError if it is another upload, or not whole.
        """
        if self._of != (device, upload) or hashlib.sha256(self._content).digest() != sha256:
            raise CommandRefusedError(RefusalCode.UPLOAD_INCOMPLETE)
        content = bytes(self._content)
        self._of, self._content = None, bytearray()
        return content
