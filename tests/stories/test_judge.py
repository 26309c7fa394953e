"""The judge: a case passes only when all of its row holds."""

import pytest

from tests.stories.drill import LOST_FRAMES, Outcome, Standstill
from tests.stories.judge import judge
from tests.stories.table import CASES, DrillRow, case_of

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


DRIVEN_ON = case_of("tick", "wrong").must
"""Row of a robot that drives on."""
SENSED = case_of("sensor_board_1", "slow").must
STALE = Standstill(0.05, ("range sensors stale",))
STUTTERED = DROVE._replace(first=STALE, went_on=True, last=STALE)
LOST = DROVE._replace(counted={LOST_FRAMES: 3})


def test_outcomes_as_their_rows_say_pass() -> None:
    turned = DROVE._replace(first=Standstill(0.3, ("slew limit",)), went_on=True, longest_stand_s=0.02)
    logged = case_of("recorder", "off").must
    for must, outcome in ((HUNG, STOOD), (DRIVEN_ON, DROVE), (DRIVEN_ON, turned), (SENSED, STUTTERED), (logged, LOST)):
        assert judge(must, outcome) == []


@pytest.mark.parametrize(
    ("must", "outcome", "complaint"),
    [
        (HUNG, STOOD._replace(last=None, went_on=True), "must stand because of"),
        (HUNG, STOOD._replace(last=Standstill(0.2, ("ticks ceased",))), "must stand within 110 ms, took 200.0"),
        (HUNG, STOOD._replace(last=Standstill(0.1, ("bus lost",))), "stood because of"),
        (HUNG, STOOD._replace(latched="bus lost"), "must stay stopped"),
        (HUNG, STOOD._replace(latched=None), "must stay stopped"),
        (HUNG, STOOD._replace(latched_after_s=0.3), "must be stopped for good within"),
        (HUNG, STOOD._replace(drove_by_itself=True), "drove by itself"),
        (HUNG, STOOD._replace(drove_when_told=False), "must drive after resume"),
        (HUNG, STOOD._replace(old_frames=1), "1 old set points"),
        (HUNG, STOOD._replace(problems=("0.70 m/s",)), "0.70 m/s"),
        (HUNG, STOOD._replace(acted=False), "nothing failed"),
        (DRIVEN_ON, DROVE._replace(first=STALE, longest_stand_s=0.1), "must drive on, stood for 0.10 s"),
        (SENSED, STUTTERED._replace(went_on=False), "must go on in between"),
        (case_of("tick", "delayed").must, DROVE._replace(counted={"missed ticks": 0}), "no missed ticks"),
        (case_of("recorder", "slow").must, LOST, "lost 3 frames"),
    ],
)
def test_each_part_of_a_row_is_looked_at(must: DrillRow, outcome: Outcome, complaint: str) -> None:
    (said,) = judge(must, outcome)
    assert complaint in said


def test_judge_fault_without_effect_passes_only_drives_on() -> None:
    for case in CASES:
        counted = {case.must.counts: 1} if case.must.counts else {}
        drives_on = case.must.leads_to == "drives_on"
        assert (judge(case.must, DROVE._replace(counted=counted)) == []) is drives_on, str(case)
