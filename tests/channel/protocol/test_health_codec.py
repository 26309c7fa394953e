"""The report as it goes over the wire and into JSON, and back."""

import json
from dataclasses import replace
from typing import Any

import pytest

from kurt2rt.channel.protocol.codec import decode_answer, encode_answer
from kurt2rt.channel.protocol.health import HEALTH, MOST_ROWS, HealthReport, Trouble
from kurt2rt.channel.protocol.trouble_code import TroubleCode
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.progress import Progress
from tests.service.health.reports import ILL, LATE, WELL


@pytest.mark.parametrize(
    "report",
    [
        WELL,
        ILL,
        replace(WELL, bus=None),
        replace(WELL, progress=Progress(60, 87, 3)),
        replace(WELL, plugins=("policies flight from flight 0.1.0, hash 1a2b3c4d",)),
    ],
)
def test_it_comes_back_as_it_went(report: HealthReport) -> None:
    assert HEALTH.read(json.loads(json.dumps(HEALTH.plain_of(report), allow_nan=False))) == report
    assert HEALTH.read(decode_answer(encode_answer({"health": HEALTH.plain_of(report)}))["health"]) == report


def test_health_codec_any_error_text_stays_readable() -> None:
    odd = Trouble(TroubleCode.PROGRAM, 1.0, False, "channel", (), "first line\nsecond\t" + "x" * 1000)
    told = HEALTH.read(HEALTH.plain_of(replace(ILL, troubles=(odd,) * 40)))
    assert len(told.troubles) == MOST_ROWS
    assert "\n" not in told.troubles[0].what
    assert "\t" not in told.troubles[0].what


@pytest.mark.parametrize(
    "broken",
    [
        None,
        [],
        {},
        {**HEALTH.plain_of(WELL), "ages": None},
        {**HEALTH.plain_of(WELL), "uptime_s": "long"},
        {**HEALTH.plain_of(WELL), "troubles": [{"what": "no more"}]},
        {**HEALTH.plain_of(ILL), "troubles": [{**HEALTH.plain_of(ILL)["troubles"][0], "code": "unheard of"}]},
        {
            **HEALTH.plain_of(WELL),
            "troubles": [{**HEALTH.plain_of(replace(ILL, troubles=(LATE,)))["troubles"][0], "numbers": [3]}],
        },
    ],
)
def test_health_codec_malformed_report_is_refused(broken: Any) -> None:
    with pytest.raises(WireError, match=r"has|is missing"):
        HEALTH.read(broken)
