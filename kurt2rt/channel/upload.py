"""Upload of a file, part by part, into memory."""

import hashlib

from kurt2rt.channel.requests import MOST_UPLOAD_BYTES


class Upload:
    """The one file that is being uploaded; a newer one takes its place."""

    def __init__(self, most_bytes: int = MOST_UPLOAD_BYTES) -> None:
        self._most_bytes = most_bytes
        self._of: tuple[str, bytes] | None = None
        self._content = bytearray()

    def add(self, device: str, upload: bytes, offset: int, part: bytes) -> int:
        """Add a part that begins where the parts so far end; return how many bytes are there.

        A part that is there already, as a copy of a request brings it, changes nothing. Raises ValueError.
        """
        if self._of != (device, upload):
            if offset != 0:
                raise ValueError("this upload was not begun here, or another one has taken its place; begin again at 0")
            self._of, self._content = (device, upload), bytearray()
        if offset > len(self._content):
            raise ValueError(f"a part is missing: got the one at {offset}, the next byte is {len(self._content)}")
        if offset + len(part) > self._most_bytes:
            raise ValueError(f"the file is too large (at most {self._most_bytes} bytes); give it to kurt2rt run")
        if self._content[offset : offset + len(part)] not in (b"", part):
            raise ValueError(f"the part at {offset} is another one than before; begin again with another id")
        self._content[offset : offset + len(part)] = part
        return len(self._content)

    def take(self, device: str, upload: bytes, sha256: bytes) -> bytes:
        """Return the whole file and forget it. Raises ValueError where it is not this one, whole."""
        if self._of != (device, upload) or hashlib.sha256(self._content).digest() != sha256:
            raise ValueError("the file did not arrive whole (SHA-256); upload it again")
        content = bytes(self._content)
        self._of, self._content = None, bytearray()
        return content
