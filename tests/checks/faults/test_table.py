"""The table of faults: whole, in the program's own words, and refused when it is not."""

import json
from pathlib import Path
from typing import Any

import pytest

from config import CONFIG_DIR
from hal.guard_reason import GuardReason
from hal.settings import SettingsError, content_of
from kurt2rt.checks.faults.table import cases_of, load_faults
from kurt2rt.core.decision.decision import DecisionCause
from tests.checks.faults.helpers import ROBOT, TABLE, tried

SHIPPED = CONFIG_DIR / "faults" / "kurt2.yaml"
WORDS = {*GuardReason, *DecisionCause}


def changed(tmp_path: Path, change: Any) -> Path:
    content = content_of(SHIPPED)
    change(content)
    path = tmp_path / "faults.yaml"
    path.write_text(json.dumps(content))
    return path


def test_it_speaks_the_words_of_guard_and_runtime() -> None:
    for case in cases_of(TABLE):
        assert {*case.must.words, *([case.must.latches] if case.must.latches else [])} <= WORDS, str(case)


def test_each_row_says_why() -> None:
    for case in cases_of(TABLE):
        assert len(case.must.why.split()) >= 3, str(case)


def test_required_counter_is_counted() -> None:
    wanted = {case.must.counts for case in cases_of(TABLE)} - {None}
    assert wanted <= tried("sensor_board_1", "off").outcome.counted.keys()


def test_its_envelope_is_that_of_the_robot() -> None:
    limits = TABLE.envelope
    assert limits.speed_m_s == ROBOT.guard.maximum_speed_m_s
    assert limits.acceleration_m_s2 == ROBOT.guard.acceleration_m_s2
    assert limits.braking_m_s2 == ROBOT.guard.braking_m_s2
    assert limits.command_age_s == ROBOT.guard.command_age_s
    assert limits.controller_watchdog_s == ROBOT.motors.controller_watchdog_s


def test_a_missing_case_is_named(tmp_path: Path) -> None:
    def forget_one(content: Any) -> None:
        del content["cases"]["clock"]["slow"]

    with pytest.raises(SettingsError, match="clock slow"):
        load_faults(str(changed(tmp_path, forget_one)))


@pytest.mark.parametrize(
    ("target", "kind", "update", "field"),
    [
        ("tick", "garbage", {"within_s": None}, "within_s"),
        ("tick", "wrong", {"because": "slew limit"}, "because"),
        ("tick", "stuck", {"latches_within_s": None}, "latches_within_s"),
        ("tick", "wrong", {"ends_by": "resume"}, "ends_by"),
        ("disk", "slow", {"leads_to": "runs away"}, "leads_to"),
    ],
)
def test_a_row_that_makes_no_sense_is_refused(
    tmp_path: Path, target: str, kind: str, update: dict[str, object], field: str
) -> None:
    def spoil(content: Any) -> None:
        content["cases"][target][kind].update(update)

    with pytest.raises(SettingsError, match=rf"cases\.{target}\.{kind}.*{field}"):
        load_faults(str(changed(tmp_path, spoil)))
