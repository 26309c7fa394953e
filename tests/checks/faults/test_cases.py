"""All 84 cases: something fails while the robot drives, and what the table says comes of it."""

import pytest

from kurt2rt.checks.faults.stop_times import stop_times
from kurt2rt.checks.faults.table import KINDS, TARGETS, FaultCase, Kind, Target, cases_of
from tests.checks.faults.helpers import TABLE, tried

CASES = list(cases_of(TABLE))


def is_quick(case: FaultCase) -> bool:
    """Return whether a case is in the quick sixth: of each target a kind, of each kind several targets."""
    return (TARGETS.index(case.target) + KINDS.index(case.kind)) % 6 == 0


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[] if is_quick(case) else pytest.mark.deep, id=str(case)) for case in CASES]
)
def test_fault_cases_lead_to_their_rows(case: FaultCase) -> None:
    trial = tried(case.target, case.kind)
    assert trial.verdict.passed, trial.verdict.complaints


@pytest.mark.deep
@pytest.mark.parametrize("case", CASES, ids=str)
def test_fault_cases_lead_to_their_rows_for_other_seeds(case: FaultCase) -> None:
    verdicts = {seed: tried(case.target, case.kind, seed=seed).verdict for seed in range(2, 12)}
    assert {seed: verdict.complaints for seed, verdict in verdicts.items() if not verdict.passed} == {}


@pytest.mark.deep
def test_stop_times_meet_their_goals() -> None:
    wanted = {(each.target, each.kind) for each in TABLE.stop_times}
    trials = [tried(target, kind, seed=seed) for target, kind in sorted(wanted) for seed in range(1, 31)]
    times = stop_times(TABLE, trials)
    assert len(times) == len(TABLE.stop_times)
    assert [each.what for each in times if not each.met] == []


@pytest.mark.parametrize(
    ("target", "kind"),
    [pytest.param("sensor_board_1", "garbage", marks=pytest.mark.deep), ("disk", "intermittent")],
)
def test_the_same_seed_comes_to_the_same(target: Target, kind: Kind) -> None:
    assert tried(target, kind, seed=7).outcome == tried(target, kind, seed=7).outcome


def test_the_quick_ones_leave_out_no_target_and_no_kind() -> None:
    quick = list(filter(is_quick, CASES))
    assert len(quick) == len(CASES) / 6
    assert {case.target for case in quick} == set(TARGETS)
    assert {case.kind for case in quick} == set(KINDS)


def test_the_table_leaves_nothing_to_chance() -> None:
    assert len(CASES) == len(TARGETS) * len(KINDS) == 84
    assert len({(case.target, case.kind) for case in CASES}) == 84
