"""The report in words."""

from dataclasses import replace

import pytest

from kurt2rt.channel.protocol.health import Trouble
from kurt2rt.channel.protocol.health_text import lasting, rows_of, size, trouble_in
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from tests.service.health.reports import WELL


def test_trouble_without_a_remedy_has_its_duration() -> None:
    drops = Trouble(TroubleCode.DROPS, 185.0, False, "lines", (40,))
    assert trouble_in(drops) == f"{drops.what} (for 3 min 5 s)"


@pytest.mark.parametrize(
    ("seconds", "words"), [(0.4, "0 s"), (59.4, "59 s"), (59.6, "1 min 0 s"), (3725, "1 h 2 min"), (90_000, "1 d 1 h")]
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
