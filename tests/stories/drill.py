"""A drill: the robot drives, one part fails for a while and recovers, and what comes of it is held to its row."""

import random
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

from hal.kurt2_settings import Kurt2Settings
from kurt2rt.core.teaching.commands import ReplaceAction, Resume, Stop, Teach, Watch
from kurt2rt.core.tick_record import TickRecord
from tests.stories.device import TEACHER, Device
from tests.stories.program import Program
from tests.stories.rig import CORRIDOR, ROBOT, Rig
from tests.stories.table import TABLE, DrillRow, Kind, Target
from tests.stories.witness import Witness

_BEGINS_S, _LASTS_S = 2.0, 2.0
_SETTLES_S, _DRIVES_AGAIN_S = 0.3, 0.3
"""Times to drive again: by itself after the fault, and after a teacher's command."""
_LOST_FRAMES = "lost frames"
"""Word of the table for frames missing in the CAN log."""
_MOMENT_S = 0.03
"""Longest standstill of a robot that reverses, some ticks."""
_ACTION = "along_left_wall"
_LESSON_EVERY_S = 0.25


class _Drill:
    def __init__(
        self, target: Target, kind: Kind, must: DrillRow, seed: int, folder: Path, settings: Kurt2Settings
    ) -> None:
        self._must, self._folder, self._settings = must, folder, settings
        self._by_hand = target == "teacher_link"
        self._chance = random.Random(f"drill {target} {kind} {seed}")
        self.rig = Rig(settings, CORRIDOR, self._chance)
        self._witness = Witness(self.rig)
        self._device = Device(self.rig.injection, self._chance)
        # The phases of ticks and fault against the controller's cycle.
        self.rig.time.run_until(self._chance.uniform(0.1, 0.9) * settings.cycle_s)
        begin_s = _BEGINS_S + self._chance.uniform(0.0, settings.cycle_s)
        self._program = self._started(1)
        self._fault = TABLE.fault(target, kind, begin_s, begin_s + (must.drill_lasts_s or _LASTS_S))
        self._witness.watch()
        self.rig.injection.plan(self._fault)
        self._program.begin_fault(self._fault)
        self._rehearse()
        self._resume_at_s = self._fault.end_s + _SETTLES_S
        self._latched: str | None = None
        self._counted: dict[str, int] = {}

    async def run(self) -> list[str]:
        """Run to the end, with a restart of the program if the fault ended it; return what is not as the row says."""
        program, time = self._program, self.rig.time
        over_at_s = self._resume_at_s
        if self._must.ends_by != "itself":
            over_at_s += _DRIVES_AGAIN_S
        await program.run(self._teach, lambda: time.now_s() >= over_at_s)
        problems = []
        if program.ended_by:
            time.run_until(self._resume_at_s)
            self._note_the_end()
            problems += program.close()
            self._program = self._started(2)
            await self._program.run(self._teach, lambda: time.now_s() >= over_at_s)
        problems += [*self._limits(), *self._standstill(), *self._latch(program.ended_by), *self._end()]
        problems += self._program.end_fault(self._fault)
        return problems + self._program.close() + self._witness.complaints

    def _started(self, number: int) -> Program:
        program = Program(self.rig, self._witness, self._device, self._folder, number, self._chance)
        program.put(Resume(program.next_id(), TEACHER))
        return program

    def _rehearse(self) -> None:
        """Let happen what the case needs besides its fault: lessons for the disk, a stop for a motor."""
        program, begin_s = self._program, self._fault.begin_s
        if self._fault.target == "disk":
            for number in range(int((self._fault.end_s - begin_s) / _LESSON_EVERY_S)):
                self.rig.time.at(begin_s + number * _LESSON_EVERY_S, self._repeat_known_lesson)
        if self._must.stop_said_after_s is not None:
            stop = Stop(program.next_id(), TEACHER)
            self.rig.time.at(begin_s + self._must.stop_said_after_s, lambda: program.put(stop))

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
            elif self._must.ends_by == "resume":
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
            _LOST_FRAMES: 0 if program.log is None else program.log.lost,
        }

    def _limits(self) -> Iterator[str]:
        must, old_frames, lost = self._must, self._witness.envelope.old_frames, self._counted[_LOST_FRAMES]
        if self._fault not in self.rig.injection.acted:
            yield "nothing failed"
        if old_frames > must.old_frames:
            yield f"{old_frames} old set points arrived at the robot, allowed are {must.old_frames}"
        if must.counts is not None and not self._counted[must.counts]:
            yield f"no {must.counts} were counted"
        if must.counts != _LOST_FRAMES and lost:
            yield f"the log must lose nothing, lost {lost} frames"

    def _standstill(self) -> Iterator[str]:
        witness, must, begin_s, end_s = self._witness, self._must, self._fault.begin_s, self._fault.end_s
        assert not witness.standstills(begin_s - self._settings.cycle_s, begin_s), "it stood before anything failed"
        stands = witness.standstills(begin_s, end_s)
        if must.leads_to == "drives_on":
            longest_s = max((each.to_s - each.from_s for each in stands), default=0.0)
            if longest_s > _MOMENT_S:
                because = witness.causes_from(stands[0].from_s)
                yield f"must drive on, stood for {longest_s:.2f} s because of {because}"
            return
        goes_on = must.leads_to == "stutters"
        fitting = stands if goes_on else [each for each in stands if each.to_s >= end_s]
        if not fitting or must.within_s is None:
            yield f"must stand because of {must.words}, did not"
            return
        after_s, because = fitting[0].from_s - begin_s, witness.causes_from(fitting[0].from_s)
        if after_s > must.within_s:
            yield f"must stand within {must.within_s * 1000:.0f} ms, took {after_s * 1000:.1f}"
        if not set(must.words) & set(because):
            yield f"must stand because of {must.words}, stood because of {because}"
        if goes_on and fitting[0].to_s >= end_s:
            yield "must go on in between, stood to the end of the fault"

    def _latch(self, ended_by: str) -> Iterator[str]:
        must, latched = self._must, self._witness.latched
        if self._latched != must.latches:
            yield f"must stay stopped because of {must.latches}, it was {self._latched} {ended_by}"
        elif must.latches_within_s is not None and latched is not None:
            after_s = latched[0] - self._fault.begin_s
            if after_s > must.latches_within_s:
                yield f"must be stopped for good within {must.latches_within_s:g} s, took {after_s:.3f}"

    def _end(self) -> Iterator[str]:
        ends_by, drove_at_s = self._must.ends_by, self._witness.drove_at_s
        by_itself = any(self._fault.end_s < at_s <= self._resume_at_s for at_s in drove_at_s)
        if ends_by == "itself":
            if not by_itself:
                yield "must drive by itself when the fault is over, did not"
            return
        if by_itself:
            yield f"must wait for {ends_by} when the fault is over, drove by itself"
        if not any(at_s > self._resume_at_s for at_s in drove_at_s):
            yield f"must drive after {ends_by}, did not"


async def drilled(
    target: Target,
    kind: Kind,
    folder: Path,
    *,
    seed: int = 1,
    robot: Kurt2Settings = ROBOT,
    must: DrillRow | None = None,
) -> list[str]:
    """Try a case in an empty folder; return what is not as its row says, or `must` in its place.

    The seed determines noise and the phases of fault, ticks and watchdog.
    """
    drill = _Drill(target, kind, must or TABLE.cases[target][kind], seed, folder, robot)
    with closing(drill.rig):
        return await drill.run()
