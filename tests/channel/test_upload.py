"""The file that a device uploads, part by part."""

import hashlib

import pytest

from kurt2rt.channel.upload import Upload


def test_parts_in_order_make_the_file_and_copies_change_nothing() -> None:
    upload = Upload()
    assert [upload.add("phone", b"1", at, part) for at, part in ((0, b"ab"), (0, b"ab"), (2, b"c"))] == [2, 2, 3]
    assert upload.take("phone", b"1", hashlib.sha256(b"abc").digest()) == b"abc"
    with pytest.raises(ValueError, match="did not arrive whole"):
        upload.take("phone", b"1", hashlib.sha256(b"abc").digest())


def test_what_does_not_fit_is_refused_with_the_reason() -> None:
    upload = Upload(most_bytes=4)
    with pytest.raises(ValueError, match="begin again at 0"):
        upload.add("phone", b"1", 2, b"c")
    upload.add("phone", b"1", 0, b"ab")
    with pytest.raises(ValueError, match="got the one at 3, the next byte is 2"):
        upload.add("phone", b"1", 3, b"d")
    with pytest.raises(ValueError, match="another one than before"):
        upload.add("phone", b"1", 0, b"xb")
    with pytest.raises(ValueError, match="too large"):
        upload.add("phone", b"1", 2, b"cde")
    with pytest.raises(ValueError, match="did not arrive whole"):
        upload.take("phone", b"1", hashlib.sha256(b"abc").digest())


def test_another_file_or_device_takes_the_place() -> None:
    upload = Upload()
    upload.add("phone", b"1", 0, b"ab")
    assert upload.add("laptop", b"1", 0, b"x") == 1
    with pytest.raises(ValueError, match="another one has taken its place"):
        upload.add("phone", b"1", 2, b"c")
