"""Attachment of rmw_zenoh (0.2.4 and newer): sequence number, time stamp and sender of a message or request."""

import time
from itertools import count
from secrets import token_bytes
from typing import NamedTuple

from zenoh import ZBytes
from zenoh.ext import Int64, ZDeserializeError, z_deserialize, z_serialize

_GID_BYTES = 16


class RequestId(NamedTuple):
    """Sequence number and sender of a request, which its response repeats."""

    sequence_number: int
    gid: bytes


class AttachmentSource:
    """Attachments of one publisher, service or client."""

    def __init__(self) -> None:
        """Choose an identifier of 16 bytes by chance."""
        self._gid = token_bytes(_GID_BYTES)
        self._numbers = count(1)

    def next(self) -> ZBytes:
        """Return the attachment of the next message or request."""
        return _serialized(RequestId(next(self._numbers), self._gid))


def response_attachment(request: RequestId) -> ZBytes:
    """Return the attachment of the response to a request."""
    return _serialized(request)


def read_request_id(attachment: ZBytes | None) -> RequestId | None:
    """Return the identity of a request; None without a valid attachment, as the bridge sends none."""
    if attachment is None:
        return None
    try:
        number, _, gid = z_deserialize(tuple[Int64, Int64, bytes], attachment)
    except ZDeserializeError:
        return None
    return RequestId(int(number), gid) if len(gid) == _GID_BYTES else None


def _serialized(request: RequestId) -> ZBytes:
    return z_serialize((Int64(request.sequence_number), Int64(time.time_ns()), request.gid))
