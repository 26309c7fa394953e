"""Teacher of a fault scenario: answers, lessons, stop and resume."""

from collections.abc import Callable

from kurt2rt.checks.faults.fault_rig import FaultRig
from kurt2rt.checks.faults.table import FaultCase, FaultTable
from kurt2rt.checks.faults.teacher_link import TeacherLink
from kurt2rt.core.decision.active_stop import STARTED
from kurt2rt.core.teaching.commands import Command, ReplaceAction, Resume, Stop, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runtime import Runtime

_TEACHER = "ann"
_LESSON_EVERY_S = 0.25


class Script:
    """Commands at simulated times and after ticks."""

    def __init__(self, rig: FaultRig, case: FaultCase, table: FaultTable) -> None:
        self._time = rig.time
        self._case = case
        self._action = table.action
        self._begin_s, self._end_s = rig.disturbance.begin_s, rig.disturbance.end_s
        self.resume_at_s = self._end_s + table.schedule.settles_s
        """Time at which the teacher resumes the robot; before it the robot may drive by itself."""
        self.over_at_s = self.resume_at_s
        if case.must.ends_by != "itself":
            self.over_at_s += table.schedule.drives_again_s
        self._answers = 0
        self._runtime: Runtime | None = None
        self._link: TeacherLink | None = None

    def begin(self, runtime: Runtime, link: TeacherLink | None) -> None:
        """Schedule the teacher's commands of the case; call it before the first tick.

        `link`: of a teacher who drives manually; None: no such teacher.
        """
        self._runtime, self._link = runtime, link
        at, must = self._time.at, self._case.must
        if link is not None:
            link.press()
            link.start()
        match must.ends_by:
            case "resume":
                at(self.resume_at_s, self.resume)
            case "press":
                assert link is not None
                at(self.resume_at_s, link.press)
        if must.stop_said_after_s is not None:
            at(self._begin_s + must.stop_said_after_s, self._command_sender(Stop("stop", _TEACHER)))
        if self._case.target == "disk":
            for number in range(int((self._end_s - self._begin_s) / _LESSON_EVERY_S)):
                # It changes nothing: what the robot does then is for the disk's sake alone.
                lesson = ReplaceAction(f"lesson-{number}", _TEACHER, 1, self._action)
                at(self._begin_s + number * _LESSON_EVERY_S, self._command_sender(lesson))

    def restart(self, runtime: Runtime) -> None:
        """Continue on the runtime of a restarted program: stop it and send the command to resume."""
        self._runtime, self._link = runtime, None
        runtime.handler.stop(STARTED)
        self.resume()

    def resume(self) -> None:
        """Put the command to resume into the robot's inbox."""
        self._send(Resume("resume", _TEACHER))

    def after_tick(self, record: TickRecord) -> None:
        """Answer a question while no fault is active; call it after each tick."""
        if self._link is not None:
            self._link.set_displayed_tick(record.tick)
        elif record.decision.asking and not self._begin_s <= self._time.now_s() < self.resume_at_s:
            self._answers += 1
            self._send(Teach(f"answer-{self._answers}", _TEACHER, self._action))

    def _command_sender(self, command: Command) -> Callable[[], None]:
        return lambda: self._send(command)

    def _send(self, command: Command) -> None:
        assert self._runtime is not None
        self._runtime.inbox.put(command)
