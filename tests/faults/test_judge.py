"""The judge: a case passes only when all of its row holds."""

import pytest

from tests.faults.drill import LOST_FRAMES, Outcome, Standstill
from tests.faults.judge import judge
from tests.faults.table import CASES, case_of

STOOD = Outcome(
    first=Standstill(0.105, ("ticks ceased",)),
    last=Standstill(0.105, ("ticks ceased",)),
    went_on=False,
    longest_stand_s=1.9,
    latched="ticks ceased",
    latched_after_s=0.105,
    ended_by="",
    drove_by_itself=False,
    drove_when_told=True,
    old_frames=0,
    counted={"missed ticks": 200},
    acted=True,
)
HUNG = case_of("tick", "stuck").must
DROVE = STOOD._replace(
    first=None,
    last=None,
    longest_stand_s=0.0,
    latched=None,
    latched_after_s=None,
    drove_by_itself=True,
    drove_when_told=False,
)


def test_judge_expected_outcome_passes() -> None:
    assert judge(HUNG, STOOD) == []
    assert judge(case_of("tick", "wrong").must, DROVE) == []


@pytest.mark.parametrize(
    ("outcome", "complaint"),
    [
        (STOOD._replace(last=None, went_on=True), "must stand because of"),
        (STOOD._replace(last=Standstill(0.2, ("ticks ceased",))), "must stand within 110 ms, took 200.0"),
        (STOOD._replace(last=Standstill(0.1, ("bus lost",))), "stood because of"),
        (STOOD._replace(latched="bus lost"), "must stay stopped"),
        (STOOD._replace(latched=None), "must stay stopped"),
        (STOOD._replace(latched_after_s=0.3), "must be stopped for good within"),
        (STOOD._replace(drove_by_itself=True), "drove by itself"),
        (STOOD._replace(drove_when_told=False), "must drive after resume"),
        (STOOD._replace(old_frames=1), "1 old set points"),
        (STOOD._replace(problems=("0.70 m/s",)), "0.70 m/s"),
        (STOOD._replace(acted=False), "nothing failed"),
    ],
)
def test_each_part_of_a_row_is_looked_at(outcome: Outcome, complaint: str) -> None:
    (said,) = judge(HUNG, outcome)
    assert complaint in said


def test_judge_drives_on_allows_a_short_rest_to_reverse() -> None:
    must = case_of("tick", "wrong").must
    turned = DROVE._replace(first=Standstill(0.3, ("slew limit",)), went_on=True, longest_stand_s=0.02)
    assert judge(must, turned) == []
    assert judge(must, turned._replace(longest_stand_s=0.1)) != []


def test_one_that_must_stutter_must_not_stand_for_good() -> None:
    must = case_of("sensor_board_1", "slow").must
    stand = Standstill(0.05, ("range sensors stale",))
    stuttered = DROVE._replace(first=stand, went_on=True, last=Standstill(1.9, ("range sensors stale",)))
    assert judge(must, stuttered) == []
    (said,) = judge(must, stuttered._replace(went_on=False))
    assert "must go on in between" in said


def test_judge_fault_without_effect_passes_only_drives_on() -> None:
    for case in CASES:
        counted = {case.must.counts: 1} if case.must.counts else {}
        drives_on = case.must.leads_to == "drives_on"
        assert (judge(case.must, DROVE._replace(counted=counted)) == []) is drives_on, str(case)


def test_judge_missing_counter_fails() -> None:
    (said,) = judge(case_of("tick", "delayed").must, DROVE._replace(counted={"missed ticks": 0}))
    assert "no missed ticks" in said


def test_a_log_loses_only_what_its_row_says() -> None:
    lost = DROVE._replace(counted={LOST_FRAMES: 3})
    assert judge(case_of("recorder", "off").must, lost) == []
    (said,) = judge(case_of("recorder", "slow").must, lost)
    assert "lost 3 frames" in said
