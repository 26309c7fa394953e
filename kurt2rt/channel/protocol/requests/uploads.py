"""Knowledge that a teacher brings along."""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.channel.protocol.requests.field_types import Boot, Number
from kurt2rt.channel.protocol.requests.limits import SHA256_BYTES, UPLOAD_ID_BYTES, UPLOAD_PART_BYTES
from kurt2rt.channel.protocol.requests.request import CommandRequest, Request
from kurt2rt.channel.protocol.schema import Bytes, BytesUpTo

UploadId = Annotated[bytes, Bytes(UPLOAD_ID_BYTES)]


@dataclass(frozen=True, slots=True)
class UploadRequest(Request):
    """One part of a file, in order; a part that came already changes nothing."""

    path: ClassVar[str] = "/upload"
    boot: Boot
    upload: UploadId
    """Random, the same for all parts of one file."""
    offset: Number
    """Position of the part's first byte in the file; 0 begins the file."""
    part: Annotated[bytes, BytesUpTo(UPLOAD_PART_BYTES)]


@dataclass(frozen=True, slots=True)
class LoadRequest(CommandRequest):
    """Begin the next run with the knowledge that was uploaded, in simulation."""

    path: ClassVar[str] = "/load"
    upload: UploadId
    sha256: Annotated[bytes, Bytes(SHA256_BYTES)]
    """Of the whole file."""
