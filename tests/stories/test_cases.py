"""All 84 cases: something fails while the robot drives, and what the table says comes of it."""

from pathlib import Path
from typing import get_args

import pytest

from hal.guard_reason import GuardReason
from kurt2rt.core.decision.decision import DecisionCause
from tests.stories.drill import drilled
from tests.stories.rig import ROBOTS
from tests.stories.story import all_kinds
from tests.stories.table import KINDS, TABLE, TARGETS, Kind, RobotKind, Target

CASES = [(target, kind) for target in TARGETS for kind in KINDS]


def is_quick(target: Target, kind: Kind) -> bool:
    """Return whether a case is in the quick sixth: of each target a kind, of each kind several targets."""
    return (TARGETS.index(target) + KINDS.index(kind)) % 6 == 0


@pytest.mark.parametrize(
    ("target", "kind"), [pytest.param(*each, marks=[] if is_quick(*each) else pytest.mark.deep) for each in CASES]
)
async def test_fault_cases_lead_to_their_rows(target: Target, kind: Kind, tmp_path: Path) -> None:
    assert await drilled(target, kind, tmp_path) == []


@pytest.mark.deep
@pytest.mark.parametrize(("target", "kind"), CASES)
async def test_fault_cases_lead_to_their_rows_for_other_seeds(target: Target, kind: Kind, tmp_path: Path) -> None:
    for seed in range(2, 12):
        (tmp_path / str(seed)).mkdir()
        assert await drilled(target, kind, tmp_path / str(seed), seed=seed) == [], seed


@pytest.mark.parametrize(
    ("target", "kind", "changes", "complaint"),
    [
        ("tick", "stuck", {"within_s": 0.05}, "must stand within 50 ms, took 1"),
        ("tick", "stuck", {"because": "bus lost"}, "must stand because of ('bus lost',), stood because of"),
        ("tick", "stuck", {"latches": "bus lost"}, "must stay stopped because of bus lost, it was ticks ceased"),
        ("tick", "stuck", {"latches_within_s": 0.05}, "must be stopped for good within 0.05 s, took 0.1"),
        ("tick", "stuck", {"ends_by": "itself"}, "must drive by itself when the fault is over, did not"),
        ("tick", "stuck", {"ends_by": "press"}, "must drive after press, did not"),
        ("tick", "stuck", {"leads_to": "stutters"}, "must go on in between"),
        ("tick", "stuck", {"leads_to": "drives_on"}, "must drive on, stood for 1"),
        ("tick", "stuck", {"counts": "junk frames"}, "no junk frames were counted"),
        ("tick", "wrong", {"leads_to": "stands", "within_s": 0.1}, "must stand because of (), did not"),
        ("tick", "wrong", {"ends_by": "resume"}, "must wait for resume when the fault is over, drove by itself"),
        ("tick", "wrong", {"drill_lasts_s": 1e-9}, "nothing failed"),
        ("bus_out", "delayed", {"old_frames": 0}, "old set points arrived at the robot, allowed are 0"),
        ("recorder", "off", {"counts": None}, "the log must lose nothing, lost "),
    ],
)
async def test_each_part_of_a_row_is_looked_at(
    target: Target, kind: Kind, changes: dict[str, object], complaint: str, tmp_path: Path
) -> None:
    said = await drilled(target, kind, tmp_path, must=TABLE.cases[target][kind].model_copy(update=changes))
    assert any(complaint in each for each in said), said


def test_the_table_has_every_kind_of_every_target() -> None:
    assert [(target, kind) for target, rows in TABLE.cases.items() for kind in rows] == CASES


def test_the_quick_ones_leave_out_no_target_and_no_kind() -> None:
    quick = [each for each in CASES if is_quick(*each)]
    assert len(quick) == len(CASES) / 6
    assert ({target for target, _ in quick}, {kind for _, kind in quick}) == ({*TARGETS}, {*KINDS})


def test_the_table_speaks_the_words_of_guard_and_runtime() -> None:
    assert {word for each in all_kinds() for word in TABLE.row(*each).reasons} <= {*GuardReason, *DecisionCause}


@pytest.mark.parametrize("kind", get_args(RobotKind))
def test_the_envelope_is_that_of_the_robot(kind: RobotKind) -> None:
    limits, robot = TABLE.envelopes[kind], ROBOTS[kind]
    assert limits.speed_m_s == robot.guard.maximum_speed_m_s
    assert limits.acceleration_m_s2 == robot.guard.acceleration_m_s2
    assert limits.braking_m_s2 == robot.guard.braking_m_s2
    assert limits.command_age_s == robot.guard.command_age_s
    assert limits.controller_watchdog_s == robot.motors.controller_watchdog_s
