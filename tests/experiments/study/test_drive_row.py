"""Rows of drives, and the examiner of taught robots; targets and who is judged by them."""

import re

import anyio
import pytest

from kurt2rt.experiments.lockstep.drive_row import ExamVerdict
from kurt2rt.experiments.study import examination as module
from kurt2rt.experiments.study.examination import Examiner
from kurt2rt.experiments.study.seeds import make_plan
from kurt2rt.experiments.study.table import Verdict, needed_of, reasons_against_judging, targets_table
from tests.experiments.helpers import short_task
from tests.experiments.rows import FAILED, NOT_JUDGED, PASSED, row
from tests.experiments.study.here import parts_in


@pytest.mark.parametrize(
    ("policy", "collisions", "verdict"), [(PASSED, 0, PASSED), (PASSED, 1, FAILED), (FAILED, 0, NOT_JUDGED)]
)
def test_policy_that_does_not_pass_judges_no_robot(
    policy: ExamVerdict, collisions: int, verdict: ExamVerdict, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def drives(*_: object) -> list[object]:
        return [row(verdict=NOT_JUDGED, collisions=collisions)]

    monkeypatch.setattr(module, "run_drives", drives)
    examiner = Examiner(make_plan(short_task(), (1,), parts_in()).jobs[0], short_task(), "a", lambda *_: None)
    assert anyio.run(examiner.examine, row(verdict=policy), ()).verdict is verdict


def test_row_tells_how_a_drive_ended() -> None:
    stuck = row(verdict=FAILED, stuck=True, duration_s=123.0, teacher=row())
    assert (stuck.early_end, stuck.ended_early, stuck.failed, stuck.judged) == ("stuck after 123 s", True, True, True)
    assert [each.teacher and each.teacher.trail for each in (stuck, stuck.stored())] == [stuck.trail, ()]
    assert (stuck.stored(places=True).trail, stuck.stored().trail) == (stuck.trail, ())
    assert row(rescues=2).ended_early
    assert row(progress=2.0, least_progress=2.0).got_nowhere
    assert row(findings={"junctions": 8.0, "junctions right": 6.0}).right_share == 0.75


@pytest.mark.parametrize(
    ("seeds", "numbers"),
    [
        (range(100, 120), []),
        (range(80, 100), []),
        (range(100, 119), [["19", "20"]]),
        (range(79, 99), [["1", "0", "79"]]),
        (range(2990, 3010), [["10", "3000", "3999"]]),
    ],
)
def test_only_enough_robots_that_nobody_has_seen_are_judged(seeds: range, numbers: list[list[str]]) -> None:
    assert [re.findall(r"\d+", each) for each in reasons_against_judging(seeds)] == numbers


def test_targets_are_judged_unless_there_is_a_reason_not_to() -> None:
    found = [((), Verdict(str(met), "a", "b", met)) for met in (True, False)]
    found.append(((), Verdict("nothing", "a", "b", met=False, judged=False)))
    table = targets_table(found, [])
    assert [each[-1] for each in table.rows] == ["met", "MISSED", "not judged"]
    assert table.note.startswith("1 of 3 ")
    assert {each[-1] for each in targets_table(found, ["Too few."]).rows} == {"not judged"}
    assert [needed_of(0.9, robots) for robots in (20, 19, 0)] == [18, 18, 0]
