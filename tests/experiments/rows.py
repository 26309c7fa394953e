"""Stored rows of drives and lessons, written by hand."""

from collections.abc import Iterable
from typing import Any

from kurt2rt.core.task_settings import SuccessSettings
from kurt2rt.experiments.lockstep.drive_row import DriveRow, ExamVerdict
from kurt2rt.experiments.lockstep.lesson import LessonCounts
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.table import Table

MADE_OF = Provenance(task="t", robot="r", worlds="w", source="s", versions="Python 3")
PASSED, FAILED, NOT_JUDGED = ExamVerdict.PASSED, ExamVerdict.FAILED, ExamVerdict.NOT_JUDGED


def row(world: str = "a", verdict: ExamVerdict = PASSED, **more: Any) -> DriveRow:
    """Return a drive of 300 s and 8 laps without a fault, but for `more`."""
    fields: dict[str, Any] = {
        "world": world,
        "seed": 1,
        "verdict": verdict,
        "duration_s": 300.0,
        "unit": "laps",
        "progress": 8.0,
        "way_m": 70.0,
        "collisions": 0,
        "stuck": False,
        "alarm": "",
        "share_unknown": 0.034,
        "action_changes_per_s": 1.5,
        "findings": {"distance error, m": 0.05},
        "trail": ((1.0, 1.0, 0.0), (1.1, 1.0, 0.0), (1.2, 1.1, 0.8)),
    }
    return DriveRow.model_validate({**fields, **more})


def titled(tables: Iterable[Table], title: str) -> Table:
    """Return the first table whose title begins so."""
    return next(each for each in tables if each.title.startswith(title))


def cells(table: Table, place: int = 0) -> dict[str, str]:
    """Return a row of a table by the names of its columns."""
    return dict(zip(table.columns, table.rows[place], strict=True))


def judged(teachers_laps: float = 9.0, **more: Any) -> DriveRow:
    """Return a drive of 8 laps, but for `more`, with its verdict by the teacher's own drive."""
    drive = row(**more).judged_by(teachers_laps, SuccessSettings())
    return drive.model_copy(update={"teacher": row(drive.world, progress=teachers_laps)})


def lesson(seed: int, **more: Any) -> LessonCounts:
    """Return a lesson of 345 s and 90 RLAs, but for `more`."""
    fields: dict[str, Any] = {
        "seed": seed,
        "world": "a",
        "teacher": "superhuman",
        "teaching_s": 345.0,
        "rlas": 90,
        "asks": 41,
        "knowledge_hash": "0" * 64,
        "corrections": 52,
        "presses": 93,
        "rescues": 3,
        "repositions": 0,
        "deletions": 0,
        "alarms": 0,
        "collisions": 0,
    }
    return LessonCounts.model_validate({**fields, **more})
