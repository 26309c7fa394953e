"""The file that a device uploads, part by part."""

import hashlib

import pytest

from kurt2rt.channel.server.off_tick_requests import Upload
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode

ABC = hashlib.sha256(b"abc").digest()


def add(upload: Upload, offset: int, part: bytes, device: str = "phone") -> Outcome | None:
    """Add a part; return why it is refused."""
    try:
        upload.add(device, b"1", offset, part)
    except CommandRefusedError as error:
        return error.outcome
    return None


def test_upload_unfit_part_is_refused_with_code() -> None:
    upload = Upload(most_bytes=4)
    assert add(upload, 2, b"c") == Outcome(RefusalCode.UPLOAD_UNKNOWN)
    assert add(upload, 0, b"ab") is None
    assert add(upload, 3, b"d") == Outcome.of(RefusalCode.UPLOAD_GAP, offset=3, size=2)
    assert add(upload, 0, b"xb") == Outcome.of(RefusalCode.UPLOAD_DIFFERS, offset=0)
    assert add(upload, 2, b"cde") == Outcome.of(RefusalCode.UPLOAD_TOO_LARGE, most_bytes=4)
    with pytest.raises(CommandRefusedError) as refused:
        upload.pop("phone", b"1", ABC)
    assert refused.value.outcome == Outcome(RefusalCode.UPLOAD_INCOMPLETE)
