"""The judge: a case passes only when all of its row holds."""

from dataclasses import replace

import pytest

from kurt2rt.checks.faults.complaint import ComplaintCode, complaint
from kurt2rt.checks.faults.judge import judge
from kurt2rt.checks.faults.outcome import FaultOutcome, Standstill
from kurt2rt.checks.faults.table import cases_of
from tests.checks.faults.helpers import TABLE, case_of

STOOD = FaultOutcome(
    target="tick",
    kind="stuck",
    seed=1,
    first=Standstill(0.105, ("ticks ceased",)),
    last=Standstill(0.105, ("ticks ceased",)),
    went_on=False,
    longest_stand_s=1.9,
    latched="ticks ceased",
    latched_after_s=0.105,
    ended_by="",
    drove_by_itself=False,
    drove_when_told=True,
    oldest_age_s=0.0,
    old_frames=0,
    frames=400,
    counted={"missed ticks": 200},
)
TOO_FAST = complaint(ComplaintCode.TOO_FAST, 2.1, speed_m_s=0.7)
HUNG = case_of("tick", "stuck").must
DROVE = replace(
    STOOD,
    first=None,
    last=None,
    longest_stand_s=0.0,
    latched=None,
    latched_after_s=None,
    drove_by_itself=True,
    drove_when_told=False,
)


def test_judge_expected_outcome_passes() -> None:
    assert judge(HUNG, STOOD).passed
    assert judge(case_of("tick", "wrong").must, DROVE).passed


@pytest.mark.parametrize(
    ("outcome", "code"),
    [
        (DROVE, ComplaintCode.DID_NOT_STAND),
        (replace(STOOD, last=None, went_on=True), ComplaintCode.DID_NOT_STAND),
        (replace(STOOD, last=Standstill(0.2, ("ticks ceased",))), ComplaintCode.STOOD_LATE),
        (replace(STOOD, last=Standstill(0.1, ("bus lost",))), ComplaintCode.STOOD_FOR_ANOTHER_CAUSE),
        (replace(STOOD, latched="bus lost"), ComplaintCode.OTHER_LATCH),
        (replace(STOOD, latched=None), ComplaintCode.OTHER_LATCH),
        (replace(STOOD, latched_after_s=0.3), ComplaintCode.LATCHED_LATE),
        (replace(STOOD, drove_by_itself=True), ComplaintCode.DROVE_BY_ITSELF),
        (replace(STOOD, drove_when_told=False), ComplaintCode.DID_NOT_DRIVE_WHEN_TOLD),
        (replace(STOOD, old_frames=1), ComplaintCode.OLD_FRAMES),
        (replace(STOOD, problems=(TOO_FAST,)), ComplaintCode.TOO_FAST),
    ],
)
def test_each_part_of_a_row_is_looked_at(outcome: FaultOutcome, code: ComplaintCode) -> None:
    verdict = judge(HUNG, outcome)
    assert not verdict.passed
    assert code in [each.code for each in verdict.complaints]


def test_judge_drives_on_allows_a_short_rest_to_reverse() -> None:
    must = case_of("tick", "wrong").must
    turned = replace(DROVE, first=Standstill(0.3, ("slew limit",)), went_on=True, longest_stand_s=0.02)
    assert judge(must, turned).passed
    assert not judge(must, replace(turned, longest_stand_s=0.1)).passed


def test_one_that_must_stutter_must_not_stand_for_good() -> None:
    must = case_of("sensor_board_1", "slow").must
    stuttered = replace(
        DROVE, first=Standstill(0.05, ("infra-red stale",)), went_on=True, last=Standstill(1.9, ("infra-red stale",))
    )
    assert judge(must, stuttered).passed
    (complaint_of, *_) = judge(must, replace(stuttered, went_on=False)).complaints
    assert complaint_of.code is ComplaintCode.DID_NOT_GO_ON


def test_judge_fault_without_effect_passes_only_drives_on() -> None:
    for case in cases_of(TABLE):
        counted = {case.must.counts: 1} if case.must.counts else {}
        drives_on = case.must.leads_to == "drives_on"
        assert judge(case.must, replace(DROVE, counted=counted)).passed is drives_on, str(case)


def test_judge_missing_counter_fails() -> None:
    must = case_of("tick", "delayed").must
    assert judge(must, DROVE).passed
    assert judge(must, replace(DROVE, counted={"missed ticks": 0})).complaints == (
        complaint(ComplaintCode.NOT_COUNTED, counter="missed ticks"),
    )


def test_a_log_loses_only_what_its_row_says() -> None:
    lost = replace(DROVE, counted={"lost frames": 3})
    assert judge(case_of("recorder", "off").must, lost).passed
    assert judge(case_of("recorder", "slow").must, lost).complaints == (
        complaint(ComplaintCode.LOG_LOST_FRAMES, frames=3),
    )


def test_judge_known_gap_excuses_no_envelope_violation() -> None:
    must = HUNG.model_copy(update={"known_gap": "no resume is sent"})
    stays = replace(STOOD, drove_when_told=False)
    assert judge(must, stays).passed
    assert not judge(must, replace(stays, problems=(TOO_FAST,))).passed


def test_a_gap_that_is_closed_must_be_taken_out_of_the_table() -> None:
    must = HUNG.model_copy(update={"known_gap": "no resume is sent"})
    verdict = judge(must, STOOD)
    assert not verdict.passed
    assert verdict.complaints == (complaint(ComplaintCode.GAP_CLOSED),)
