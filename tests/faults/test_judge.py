"""The judge: a case passes only when all of its row holds."""

from dataclasses import replace

import pytest

from kurt2rt.faults.judge import judge
from kurt2rt.faults.outcome import Outcome, Standstill
from kurt2rt.faults.table import cases_of
from tests.faults.helpers import TABLE, case_of

STOOD = Outcome(
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


def test_what_is_as_it_must_be_passes() -> None:
    assert judge(HUNG, STOOD).passed
    assert judge(case_of("tick", "wrong").must, DROVE).passed


@pytest.mark.parametrize(
    ("outcome", "said"),
    [
        (DROVE, "must stand because of ticks ceased, did not"),
        (replace(STOOD, last=None, went_on=True), "must stand because of ticks ceased, did not"),
        (replace(STOOD, last=Standstill(0.2, ("ticks ceased",))), "must stand within 120 ms, took 200.0"),
        (replace(STOOD, last=Standstill(0.1, ("bus lost",))), "stood because of bus lost"),
        (replace(STOOD, latched="bus lost"), "must stay stopped because of ticks ceased, it was bus lost"),
        (replace(STOOD, latched=None), "must stay stopped because of ticks ceased, it was None"),
        (replace(STOOD, latched_after_s=0.3), "must be stopped for good within 0.12 s, took 0.300"),
        (replace(STOOD, drove_by_itself=True), "must wait for resume"),
        (replace(STOOD, drove_when_told=False), "must drive after resume, did not"),
        (replace(STOOD, old_frames=1), "1 old set points arrived"),
        (replace(STOOD, problems=("at 2.1 s: 0.70 m/s",)), "0.70 m/s"),
    ],
)
def test_each_part_of_a_row_is_looked_at(outcome: Outcome, said: str) -> None:
    verdict = judge(HUNG, outcome)
    assert not verdict.passed
    assert said in "; ".join(verdict.complaints)


def test_one_that_must_drive_on_may_rest_for_a_moment_to_turn_round() -> None:
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
    assert "must go on in between" in "; ".join(judge(must, replace(stuttered, went_on=False)).complaints)


def test_a_fault_that_does_nothing_passes_only_where_nothing_must_come_of_it() -> None:
    for case in cases_of(TABLE):
        counted = {case.must.counts: 1} if case.must.counts else {}
        drives_on = case.must.leads_to == "drives_on"
        assert judge(case.must, replace(DROVE, counted=counted)).passed is drives_on, str(case)


def test_what_must_be_counted_must_be_there() -> None:
    must = case_of("tick", "delayed").must
    assert judge(must, DROVE).passed
    assert judge(must, replace(DROVE, counted={"missed ticks": 0})).complaints == ("no missed ticks were counted",)


def test_a_log_loses_only_what_its_row_says() -> None:
    lost = replace(DROVE, counted={"lost frames": 3})
    assert judge(case_of("recorder", "off").must, lost).passed
    assert judge(case_of("recorder", "slow").must, lost).complaints == ("the log must lose nothing, lost 3 frames",)


def test_a_known_gap_excuses_what_it_names_and_nothing_beyond_the_envelope() -> None:
    must = HUNG.model_copy(update={"known_gap": "nobody says resume"})
    stays = replace(STOOD, drove_when_told=False)
    assert judge(must, stays).passed
    assert not judge(must, replace(stays, problems=("at 2.1 s: 0.70 m/s",))).passed


def test_a_gap_that_is_closed_must_be_taken_out_of_the_table() -> None:
    must = HUNG.model_copy(update={"known_gap": "nobody says resume"})
    verdict = judge(must, STOOD)
    assert not verdict.passed
    assert "take it out" in verdict.complaints[0]
