"""A drill: the robot drives, one part fails for a while and recovers."""

import random
from contextlib import closing
from pathlib import Path
from typing import NamedTuple

from hal.kurt2_settings import Kurt2Settings
from kurt2rt.core.teaching.commands import ReplaceAction, Resume, Stop, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from tests.stories.device import TEACHER, Device
from tests.stories.program import Program
from tests.stories.rig import CORRIDOR, ROBOT, Rig
from tests.stories.table import TABLE, Case
from tests.stories.witness import Witness

LOST_FRAMES = "lost frames"
"""Key in `Outcome.counted` for frames missing in the CAN log."""
_ACTION = "along_left_wall"
_LESSON_EVERY_S = 0.25


class Standstill(NamedTuple):
    """Standstill of the robot by the commands on its end of the bus."""

    after_s: float
    because: tuple[str, ...]
    """Causes in the driver's first tick from then on that commanded a standstill."""


class Outcome(NamedTuple):
    """Outcome of one fault; times count from its beginning."""

    first: Standstill | None
    """First standstill during the fault; None without one."""
    last: Standstill | None
    """Standstill that lasted to the end of the fault; None if the robot drove then."""
    went_on: bool
    """True if it drove again during the fault after a standstill."""
    longest_stand_s: float
    latched: str | None
    """Guard's latch reason at the end of the fault; None without a latch."""
    latched_after_s: float | None
    ended_by: str
    """Error that ended the program; empty without one."""
    drove_by_itself: bool
    """True if it drove after the fault without a command of a teacher."""
    drove_when_told: bool
    old_frames: int
    """Set points that exceeded the age limit on arrival at the robot."""
    counted: dict[str, int]
    """Numbers of lost, refused and garbled messages."""
    acted: bool
    """True if the fault changed anything."""
    problems: tuple[str, ...] = ()
    """Complaints of the witness, lost lessons and miscounted frames."""


class _Drill:
    def __init__(self, case: Case, seed: int, folder: Path, settings: Kurt2Settings) -> None:
        self._case, self._folder, self._settings = case, folder, settings
        self._by_hand = case.target == "teacher_link"
        self._chance = random.Random(f"drill {case} {seed}")
        self.rig = Rig(settings, CORRIDOR, self._chance)
        self._witness = Witness(self.rig)
        self._device = Device(self.rig.injection, self._chance)
        # The phases of ticks and fault against the controller's cycle.
        self.rig.time.run_until(self._chance.uniform(0.1, 0.9) * settings.cycle_s)
        begin_s = TABLE.schedule.begins_at_s + self._chance.uniform(0.0, settings.cycle_s)
        self._program = self._started(1)
        self._fault = case.at(begin_s, TABLE.schedule.lasts_s)
        self._witness.watch()
        self.rig.injection.plan(self._fault)
        self._program.begin_fault(self._fault)
        self._rehearse()
        self._resume_at_s = self._fault.end_s + TABLE.schedule.settles_s
        self._latched: str | None = None
        self._counted: dict[str, int] = {}

    async def run(self) -> Outcome:
        """Run to the end, with a restart of the program if the fault ended it."""
        program, time = self._program, self.rig.time
        over_at_s = self._resume_at_s
        if self._case.must.ends_by != "itself":
            over_at_s += TABLE.schedule.drives_again_s
        await program.run(self._teach, lambda: time.now_s() >= over_at_s)
        problems = []
        if program.ended_by:
            time.run_until(self._resume_at_s)
            self._note_the_end()
            problems += program.close()
            self._program = self._started(2)
            await self._program.run(self._teach, lambda: time.now_s() >= over_at_s)
        outcome = self._outcome(program)
        problems += self._program.end_fault(self._fault)
        problems += self._program.close()
        return outcome._replace(problems=(*self._witness.complaints, *problems))

    def _started(self, number: int) -> Program:
        program = Program(self.rig, self._witness, self._device, self._folder, number, self._chance)
        program.put(Resume(program.next_id(), TEACHER))
        return program

    def _rehearse(self) -> None:
        """Let happen what the case needs besides its fault: lessons for the disk, a stop for a motor."""
        program, begin_s, must = self._program, self._fault.begin_s, self._case.must
        if self._case.target == "disk":
            for number in range(int((self._fault.end_s - begin_s) / _LESSON_EVERY_S)):
                self.rig.time.at(begin_s + number * _LESSON_EVERY_S, self._repeat_known_lesson)
        if must.stop_said_after_s is not None:
            stop = Stop(program.next_id(), TEACHER)
            self.rig.time.at(begin_s + must.stop_said_after_s, lambda: program.put(stop))

    def _repeat_known_lesson(self) -> None:
        """Teach the action of the oldest RLA once more: what the robot does then is for the disk's sake alone."""
        program = self._program
        rla = next(iter(program.runtime.level.system.rlas), None)
        if rla is not None:
            program.put(ReplaceAction(program.next_id(), TEACHER, rla.rla_id, rla.action))

    def _teach(self, record: TickRecord) -> None:
        """Resume the robot when it is due, and answer a question while no fault is active."""
        program, now_s = self._program, self.rig.time.now_s()
        if not self._counted and now_s >= self._resume_at_s:
            self._note_the_end()
            if self._by_hand:
                program.hand.press()
            elif self._case.must.ends_by == "resume":
                program.set_down()  # a motor may have turned it towards the wall, where a bumper would hold it
                program.put(Resume(program.next_id(), TEACHER))
                return
        if self._by_hand:
            return
        if record.decision.asking and not self._fault.begin_s <= now_s < self._resume_at_s:
            program.put(Teach(program.next_id(), TEACHER, _ACTION))
            return
        program.put(Watch(TEACHER, record.tick))

    def _note_the_end(self) -> None:
        program, robot = self._program, self.rig.robot
        assert robot is not None
        self._latched = robot.health.latched
        self._counted = {
            "junk frames": robot.health.junk,
            "unintelligible commands": self._witness.envelope.unintelligible,
            "missed ticks": program.runtime.timer.missed_ticks,
            "refused messages": program.hand.refused,
            LOST_FRAMES: 0 if program.log is None else program.log.lost,
        }

    def _outcome(self, program: Program) -> Outcome:
        witness, begin_s, end_s = self._witness, self._fault.begin_s, self._fault.end_s
        assert not witness.standstills(begin_s - self._settings.cycle_s, begin_s), "it stood before anything failed"
        stands = witness.standstills(begin_s, end_s)
        standstills = [Standstill(each.from_s - begin_s, witness.causes_from(each.from_s)) for each in stands]
        return Outcome(
            first=standstills[0] if stands else None,
            last=standstills[-1] if stands and stands[-1].to_s >= end_s else None,
            went_on=bool(stands) and stands[0].to_s < end_s,
            longest_stand_s=max((each.to_s - each.from_s for each in stands), default=0.0),
            latched=self._latched,
            latched_after_s=None if witness.latched is None else witness.latched[0] - begin_s,
            ended_by=program.ended_by,
            drove_by_itself=any(end_s < at_s <= self._resume_at_s for at_s in witness.drove_at_s),
            drove_when_told=any(at_s > self._resume_at_s for at_s in witness.drove_at_s),
            old_frames=witness.envelope.old_frames,
            counted=self._counted,
            acted=self._fault in self.rig.injection.acted,
        )


async def drilled(case: Case, folder: Path, *, seed: int = 1, robot: Kurt2Settings = ROBOT) -> Outcome:
    """Try a case in an empty folder; the seed determines noise and the phases of fault, ticks and watchdog."""
    drill = _Drill(case, seed, folder, robot)
    with closing(drill.rig):
        return await drill.run()
