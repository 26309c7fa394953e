"""The report in words."""

import re
from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.health_text import URGENT, WARNS, headline, lasting, lines_of, rows_of, size, trouble_in
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from tests.service.health.reports import ILL, LATE, WELL


def test_robot_that_is_well_has_no_row_with_a_trouble() -> None:
    assert "0.31 ms" in headline(WELL)
    assert all(not row.level for row in rows_of(WELL))


def test_each_row_is_as_bad_as_the_worst_trouble_about_it() -> None:
    levels = {row.name: row.level for row in rows_of(ILL) if row.level}
    assert levels == {"sensors": URGENT, "ticks": WARNS}


def test_troubles_are_named_and_not_counted() -> None:
    assert re.findall("sensors|ticks|urgent", headline(ILL)) == ["sensors", "urgent", "ticks"]
    assert re.findall("sensors|ticks|urgent", headline(replace(ILL, troubles=(LATE, LATE)))) == ["ticks"]


def test_trouble_in_appends_duration_and_remedy() -> None:
    assert trouble_in(LATE) == f"{LATE.what} (for 3 min 5 s): {LATE.to_do}"
    drops = Trouble(TroubleCode.DROPS, 185.0, False, "lines", (40,))
    assert trouble_in(drops) == f"{drops.what} (for 3 min 5 s)"
    assert f"! {trouble_in(LATE)}" in lines_of(ILL)


def test_health_text_missing_values_are_named() -> None:
    rows = {row.name: row.text for row in rows_of(replace(ILL, bus=None))}
    assert "bus" not in rows
    assert "bumpers" in rows["sensors"]
    assert "412 MB" in rows["disk"]
    assert "recordings" in rows["disk"]
    assert len(lines_of(None)) == 1


def test_ticks_row_names_recent_misses_only_if_any() -> None:
    ticks = [{row.name: row.text for row in rows_of(report)}["ticks"] for report in (WELL, ILL)]
    assert [re.findall(r"\d+", text.partition(" missed")[2]) for text in ticks] == [[], ["3"]]


@pytest.mark.parametrize(
    ("seconds", "words"),
    [(0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (3725, "1 h 2 min"), (90_000, "1 d 1 h")],
)
def test_lengths_of_time(seconds: float, words: str) -> None:
    assert lasting(seconds) == words


@pytest.mark.parametrize(("count", "words"), [(900, "1 kB"), (136_183_808, "136 MB"), (79_893_155_840, "79.9 GB")])
def test_sizes(count: int, words: str) -> None:
    assert size(count) == words


def test_plugins_in_use_have_a_row_of_their_own() -> None:
    flight = "policies flight from flight 0.1.0, hash 1a2b3c4d"
    assert "plug-ins" not in {row.name for row in rows_of(WELL)}
    assert rows_of(replace(WELL, plugins=(flight,)))[-1] == ("plug-ins", flight, "")
