"""The list of named situations, as a device takes it in."""

import pytest

from kurt2rt.channel.protocol.codec import decode_answer, encode_answer
from kurt2rt.channel.protocol.lesson_list import SITUATIONS
from kurt2rt.channel.protocol.limits import MOST_SITUATIONS
from kurt2rt.core.message_fields import LONGEST_TEXT, WireError


def test_situations_longest_list_fits_into_answer() -> None:
    names = ("😀" * LONGEST_TEXT,) * MOST_SITUATIONS
    assert SITUATIONS.read(decode_answer(encode_answer({"situations": names}))["situations"]) == names


def test_an_answer_without_them_is_refused() -> None:
    with pytest.raises(WireError, match="situations"):
        SITUATIONS.read(None)
