"""Stamps are kept as numbers, and read as they were written."""

from datetime import UTC, datetime

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kurt2rt.knowledge.stamps import Stamps
from kurt2rt.knowledge.writer import utc_now

_TIMES = st.datetimes(datetime(1, 1, 2), datetime(9999, 12, 30))


@given(st.lists(_TIMES))
def test_each_stamp_is_the_text_that_was_written(times: list[datetime]) -> None:
    written = {
        f"c-{place}": at.replace(tzinfo=UTC).isoformat(timespec="milliseconds") for place, at in enumerate(times)
    }
    stamps = Stamps(written.items())
    assert stamps == written
    assert list(stamps) == list(written)
    assert stamps.get("c-0", "") == written.get("c-0", "")


@pytest.mark.parametrize(
    "stamp",
    [
        "",
        "stamp 1",
        "2026-11-22T12:00:00",
        "2026-11-22T12:00:00.000",
        "2026-11-22T12:00:00.123456+00:00",
        "2026-11-22T13:00:00.123+01:00",
        "2026-11-22T12:00:00.123Z",
        "0001-01-01T00:00:00.000+23:59",
    ],
)
def test_whatever_else_stands_in_a_file_is_told_as_it_stands_there(stamp: str) -> None:
    assert Stamps([("c", stamp)])["c"] == stamp


def test_lessons_that_come_later_are_stamped_too() -> None:
    stamps = Stamps([("old", "2026-11-22T12:00:00.123+00:00")])
    now = stamps["new"] = utc_now()
    assert dict(stamps) == {"old": "2026-11-22T12:00:00.123+00:00", "new": now}
    del stamps["old"]
    assert stamps == {"new": now}
    assert len(stamps) == 1
    with pytest.raises(KeyError):
        stamps["old"]
