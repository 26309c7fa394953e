"""A decision of a recorded run, and when what it went by was taught."""

from dataclasses import replace
from pathlib import Path

from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.runs.explain.recorded import explain_run
from kurt2rt.runs.recording.recorder import open_run_recorder
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.runs.recording.run_head import RecordedRun
from kurt2rt.runs.replay.reader import read_run
from tests.runs.explain.helpers import ROBOT, Lesson
from tests.runs.recording.desk_recording import ATTACHMENTS, HEAD, NAME
from tests.teacher.helpers import teach

WRITTEN = "2026-11-22T03:10:07.250+00:00"


def taught_run(folder: Path) -> Path:
    """Record a run with a lesson in its first second; the slow disk gives its row a later date."""
    lesson, command = Lesson(), teach("forward")
    names = lesson.runtime.definition.names
    head = replace(HEAD, attended=False)
    recorder = open_run_recorder(folder, RecordedRun(NAME, head, ATTACHMENTS, ROBOT, names), budget_of(100))
    recorder.poll()
    lesson.go_on(20)
    lesson.go_on(80, command)
    for record in lesson.records:
        recorder.on_tick(record)
    recorder.write_waiting()
    recorder.on_acknowledged(Acknowledgement(command.command_id, 1, None, WRITTEN))
    recorder.write_waiting()
    recorder.close()
    lesson.close()
    return folder / NAME


def test_lesson_of_the_run_has_the_date_of_its_journal_row(tmp_path: Path) -> None:
    run = read_run(taught_run(tmp_path))
    nearest = explain_run(run, 1.0).facts.basic.nearest
    assert nearest is not None
    (act,) = nearest.acts
    assert act.stamp == WRITTEN
