"""All 84 cases: something fails while the robot drives, and what the table says comes of it."""

from pathlib import Path
from typing import get_args

import pytest

from hal.guard_reason import GuardReason
from kurt2rt.core.decision.decision import DecisionCause
from tests.stories.drill import drilled
from tests.stories.judge import judge
from tests.stories.rig import ROBOTS
from tests.stories.table import CASES, KINDS, TABLE, TARGETS, Case, RobotKind, case_of


def is_quick(case: Case) -> bool:
    """Return whether a case is in the quick sixth: of each target a kind, of each kind several targets."""
    return (TARGETS.index(case.target) + KINDS.index(case.kind)) % 6 == 0


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[] if is_quick(case) else pytest.mark.deep, id=str(case)) for case in CASES]
)
async def test_fault_cases_lead_to_their_rows(case: Case, tmp_path: Path) -> None:
    assert judge(case.must, await drilled(case, tmp_path)) == []


@pytest.mark.deep
@pytest.mark.parametrize("case", CASES, ids=str)
async def test_fault_cases_lead_to_their_rows_for_other_seeds(case: Case, tmp_path: Path) -> None:
    for seed in range(2, 12):
        (tmp_path / str(seed)).mkdir()
        assert judge(case.must, await drilled(case, tmp_path / str(seed), seed=seed)) == [], seed


@pytest.mark.deep
@pytest.mark.parametrize("case", [case_of("sensor_board_1", "garbage"), case_of("disk", "intermittent")])
async def test_the_same_seed_comes_to_the_same(case: Case, tmp_path: Path) -> None:
    folders = (tmp_path / "one", tmp_path / "other")
    for folder in folders:
        folder.mkdir()
    one, other = [await drilled(case, folder, seed=7) for folder in folders]
    assert one == other


def test_the_table_has_every_kind_of_every_target() -> None:
    assert [(case.target, case.kind) for case in CASES] == [(target, kind) for target in TARGETS for kind in KINDS]


def test_the_quick_ones_leave_out_no_target_and_no_kind() -> None:
    quick = list(filter(is_quick, CASES))
    assert len(quick) == len(CASES) / 6
    assert {case.target for case in quick} == set(TARGETS)
    assert {case.kind for case in quick} == set(KINDS)


def test_the_table_speaks_the_words_of_guard_and_runtime() -> None:
    words = {*GuardReason, *DecisionCause}
    for case in CASES:
        assert {*case.must.words, case.must.latches} - {None} <= words, str(case)


@pytest.mark.parametrize("kind", get_args(RobotKind))
def test_the_envelope_is_that_of_the_robot(kind: RobotKind) -> None:
    limits, robot = TABLE.envelopes[kind], ROBOTS[kind]
    assert limits.speed_m_s == robot.guard.maximum_speed_m_s
    assert limits.acceleration_m_s2 == robot.guard.acceleration_m_s2
    assert limits.braking_m_s2 == robot.guard.braking_m_s2
    assert limits.command_age_s == robot.guard.command_age_s
    assert limits.controller_watchdog_s == robot.motors.controller_watchdog_s
