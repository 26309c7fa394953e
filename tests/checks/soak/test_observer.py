"""The witness would see a program that drives when it must not, and one that loses ticks or lessons."""

import re
from pathlib import Path

import anyio
import pytest

from hal.robot import SensorReadings, WheelSpeeds
from kurt2rt.checks.faults.complaint import ComplaintCode
from kurt2rt.checks.soak.observer import SoakObserver
from kurt2rt.checks.soak.program_run import ProgramRun, ProgramStart
from kurt2rt.checks.soak.teacher import SoakTeacher
from kurt2rt.core import tick
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.decision.level import Level
from kurt2rt.core.perception.perception import Situation
from kurt2rt.service.assembly import RunSettings
from simbridge.faults.long_run_rig import LongRunRig
from tests.checks.soak.helpers import DAY, PATIENT, ROBOT, TABLE, TASK, recording_in, service_in

AWAY = PATIENT.model_copy(update={"there": False})


class Careless:
    """A level that always drives; the tick must not let it."""

    def __init__(self, behind: Level) -> None:
        self._behind = behind

    def decide(self, situation: Situation, readings: SensorReadings, stand_because: DecisionCause | None) -> Decision:
        decision = self._behind.decide(situation, readings, stand_because)
        return decision._replace(wheel_speeds=WheelSpeeds(0.1, 0.1), action="forward")


@pytest.fixture
def observer(rig: LongRunRig) -> SoakObserver:
    return SoakObserver(rig, TABLE.envelope)


def started(folder: Path, rig: LongRunRig, observer: SoakObserver, **moods: object) -> ProgramRun:
    """Return a program with a teacher of one mood."""
    soak = DAY.model_copy(update={"moods": moods})
    teacher = SoakTeacher(soak, TASK, ROBOT, ("forward", "stand"), seed=1)
    run_settings = RunSettings(ROBOT, TASK, service_in(folder))
    return ProgramRun(rig, observer, teacher, run_settings, recording_in(folder), ProgramStart(1, "none", 1))


def run(program: ProgramRun, rig: LongRunRig, until_s: float) -> None:
    anyio.run(program.run, lambda _: None, lambda: rig.time.now_s() >= until_s)


def test_program_without_a_command_stands(tmp_path: Path, rig: LongRunRig, observer: SoakObserver) -> None:
    program = started(tmp_path, rig, observer, away=AWAY)
    run(program, rig, 1.0)
    assert (observer.complaints.count, program.ended_by, program.close()) == (0, "", None)
    assert observer.stands


def test_observer_sees_a_program_that_drives_untold(
    tmp_path: Path, rig: LongRunRig, observer: SoakObserver, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(tick, "stopped", lambda decision, _: decision)
    program = started(tmp_path, rig, observer, away=AWAY)
    assert program.level.inner is not None
    program.level.inner = Careless(program.level.inner)
    run(program, rig, 1.0)
    program.close()
    assert observer.complaints.count > 80
    assert observer.complaints.stored[0].code is ComplaintCode.DROVE_UNTOLD


def test_careless_layer_does_not_drive_an_untold_program(
    tmp_path: Path, rig: LongRunRig, observer: SoakObserver
) -> None:
    program = started(tmp_path, rig, observer, away=AWAY)
    assert program.level.inner is not None
    program.level.inner = Careless(program.level.inner)
    run(program, rig, 1.0)
    assert (observer.complaints.count, program.ended_by, program.close()) == (0, "", None)
    assert observer.stands


def test_a_tick_that_is_not_accounted_for_is_seen(tmp_path: Path, rig: LongRunRig, observer: SoakObserver) -> None:
    program = started(tmp_path, rig, observer, away=AWAY)
    run(program, rig, 0.5)
    assert observer.complaints.count == 0
    program.runtime.timer.missed_ticks += 1
    run(program, rig, 0.6)
    program.close()
    (first, *_) = observer.complaints.stored
    assert (first.code, first.values["missed"]) == (ComplaintCode.TICKS_UNACCOUNTED, 1)


def test_a_lesson_that_is_not_in_the_file_is_missed(tmp_path: Path, rig: LongRunRig, observer: SoakObserver) -> None:
    program = started(tmp_path, rig, observer, patient=PATIENT)
    run(program, rig, 3.0)
    program.knowledge.submitted.append("soak-999")
    lost = program.close()
    assert lost is not None
    assert lost.code is ComplaintCode.LESSONS_NOT_STORED


def test_an_error_in_the_loop_ends_the_program_and_says_where(
    tmp_path: Path, rig: LongRunRig, observer: SoakObserver
) -> None:
    program = started(tmp_path, rig, observer, away=AWAY)
    program.level.inner = None
    run(program, rig, 1.0)
    assert re.match(r"AssertionError\(.*\) in failing_level\.py,", program.ended_by)
    assert program.close() is None
    rig.time.run_until(1.0)
    assert rig.standing
