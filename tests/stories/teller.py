"""Drives a story and judges it: what must hold whatever fails, by code that shares nothing with the guard."""

import asyncio
import ctypes
import math
import random
import shutil
from collections import Counter
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from hal import points
from hal.guard_reason import GuardReason
from hal.points import Point, never
from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import ASKING
from kurt2rt.core.rla.rla import AUTONOMOUS
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.verify import verify
from simbridge.worlds.world_loading import load_world
from tests.stories.cable import SOUND
from tests.stories.device import Device
from tests.stories.program import Program
from tests.stories.rig import ROBOT, Rig
from tests.stories.story import CALM_S, Event, Story, Teaching, because_of
from tests.stories.table import TABLE, Fault, case_of
from tests.stories.teacher import StoryTeacher
from tests.stories.witness import Witness

WORKS_AGAIN_S = 5.0
"""Time after the last fault in which the robot drives again, or asks."""
_MINUTE_TICKS = 6000
_DOWN_S = (0.5, 3.0)
_LASTING_S = 3.0
"""Time after a fault in which the robot may still stand because of it: until a teacher has said Go."""
_ALWAYS = frozenset({"stopped", "unknown", "teacher", "unattended", "front bumper", "rear bumper", "touches", "blind"})
"""Reasons to stand that need no fault: a teacher's, a question, what is in the way; blind is told by its sensors."""
_DROVE_S = 0.3
_SHOWS_M_S = 0.2
"""Slowest set point that shows whether wheels obey: in a narrow curve one side nearly stands."""
_ROUNDING_S = 1e-6
_SILENT_S = 0.35
"""Time after the teachers' last message in which the robot may drive, before phase 5."""
_MANOEUVRE = 4.0
"""Factor of the time in which wheels show that they disobey, for a robot that turns and stops in between."""
_STARTS_S = 0.1
"""Time after a start in which readings arrive."""
_OFTEN: dict[Point, float] = {
    "frames wait a cycle": 0.002,
    "the send queue is full": 0.0005,
    "a picture is old": 0.02,
    "the nearest rules are forgotten": 0.01,
    "statistics are saved now": 0.002,
    "acknowledgements wait": 0.3,
}
"""Probabilities at points that are passed often."""
_SOMETIMES = 0.15
_BECAUSE: dict[Point, frozenset[str]] = {
    "frames wait a cycle": frozenset({"bus blocked"}),
    "the send queue is full": frozenset({"bus lost"}),
    "the disk is late": frozenset({"unsaved"}),
    "the file is locked": frozenset({"unsaved"}),
    "a durable commit fails": frozenset({"unsaved"}),
}
"""Reasons to stand because of what happens at a point."""
_LIMITS = frozenset({"speed limit", "slew limit"})
_KNOWN_SEED, _KNOWN_S = 0, 40.0


@dataclass
class Told:
    """Result of a story."""

    problems: list[str] = field(default_factory=list)
    """Broken rules, in order; empty if everything held."""
    hash: str = ""
    """Hash of all set points, with their times, and of all lessons said to be durable."""
    ticks: int = 0
    starts: int = 0
    lessons: int = 0
    acted: set[str] = field(default_factory=set)
    """Faults that changed anything."""
    resident_mb: list[float] = field(default_factory=list)
    """Memory of this process after each minute of a program."""
    happened: Counter[str] = field(default_factory=Counter)
    """Number of times that something happened at each point of the program."""


class _Teller:
    def __init__(self, story: Story, folder: Path) -> None:
        self.told = Told()
        self._story, self._folder = story, folder
        self._chance = random.Random(f"told {story.seed}")
        self._task: TaskSettings = load_task(story.task)
        self.rig = Rig(ROBOT, load_world(story.world, ROBOT), self._chance)
        self._time = self.rig.time
        self._witness = Witness(self.rig)
        self._device = Device(self.rig.injection, self._chance)
        self._program: Program | None = None
        self._ends = self._is_down = False
        self._begun: list[Fault] = []
        self._begun_s = 0.0
        self._works = False
        self._reasons: frozenset[str] = frozenset()
        self._rare = random.Random(f"points {story.seed}")
        for event in story.faults:
            self._plan(event)

    async def tell(self) -> Told:
        told, story = self.told, self._story
        while self._time.now_s() < story.lasts_s:
            await self._run_program()
            self._is_down = True
            self._time.run_until(self._time.now_s() + self._chance.uniform(*_DOWN_S))
            self._is_down = False
        if not self._works:
            told.problems.append(f"it neither drove nor asked within {WORKS_AGAIN_S:g} s after the last fault")
        told.problems += self._witness.complaints
        told.acted = {str(each) for each in self.rig.injection.acted}
        digest = self._witness.digest
        digest.update("".join(sorted(self._device.saved)).encode())
        told.hash = digest.hexdigest()
        self._judge_saved()
        return told

    def _happens(self, point: Point) -> bool:
        """Return whether something happens at a point of the program now; none does at the end."""
        if point not in self._story.points or self._time.now_s() >= self._story.lasts_s - CALM_S:
            return False
        happens = self._rare.random() < _OFTEN.get(point, _SOMETIMES)
        self.told.happened[point] += happens
        return happens

    async def _run_program(self) -> None:
        told, story, chance = self.told, self._story, self._chance
        files, tasks = _open_files(), len(asyncio.all_tasks())
        told.starts += 1
        self.rig.set_down()
        program = self._program = Program(
            self.rig,
            self._witness,
            self._device,
            self._folder,
            told.starts,
            chance,
            task=self._task,
            cable=SOUND,
            records=story.records,
        )
        for fault in self._begun:
            if fault.acts(self._time.now_s()):
                program.begin_fault(fault)  # it was under way before this start
        self._ends, self._begun_s = False, self._time.now_s()
        teacher = StoryTeacher(program, self._task, story.teaching, chance)
        points.happens = self._happens
        try:
            await program.run(lambda record: self._after_tick(teacher, record), self._is_over)
        finally:
            points.happens = never
        told.ticks += program.runtime.timer.ticks
        told.lessons += len(program.knowledge.submitted)
        if program.ended_by and not self._may_end():
            told.problems.append(f"the program ended by {program.ended_by}")
        told.problems += program.close()
        self._program = None
        await self._device.wait()
        if _open_files() > files or len(asyncio.all_tasks()) > tasks:
            told.problems.append("a file or a task was left open")
        if self._can_be_replayed(program):
            assert program.recorded is not None
            verdict = verify(read_run(program.recorded, partial=True))
            if not verdict.same:
                told.problems.append(f"the replay differs after {verdict.ticks} ticks: {verdict.differences[0]}")

    def _can_be_replayed(self, program: Program) -> bool:
        """Return whether the recording of a program has all that it decided by: not what a fault put in its place."""
        falsified = {"tick garbage", "tick wrong"} & {str(each) for each in self.rig.injection.acted}
        is_whole = program.recorded is not None and program.runtime.timer.ticks > 0 and not program.killed
        return is_whole and not falsified

    def _after_tick(self, teacher: StoryTeacher, record: TickRecord) -> None:
        now_s, story = self._time.now_s(), self._story
        over_s = story.over_s
        if not teacher.is_calm and now_s >= story.lasts_s - CALM_S:
            teacher.is_calm = True
            self._set_free()
        for command in teacher.update(record):
            self._device.send(command)
        if record.number % _MINUTE_TICKS == 0:
            ctypes.CDLL(None).malloc_trim(0)
            self.told.resident_mb.append(psutil.Process().memory_info().rss / 1e6)
        moves = record.guard_result.wheel_speeds != STANDSTILL
        if now_s <= max(over_s, story.lasts_s - CALM_S) + WORKS_AGAIN_S:
            self._works = now_s >= over_s and (self._works or moves or record.decision.cause in ASKING)
        if moves and story.teaching.phase < AUTONOMOUS and now_s - self._heard_at_s() > _SILENT_S:
            told_s = now_s - self._heard_at_s()
            self.told.problems.append(f"at {now_s:.2f} s: it drives {told_s:.2f} s after its teachers' last message")
        self._explain(record, now_s)

    def _heard_at_s(self) -> float:
        """Return the time at which the newest message of any teacher arrived."""
        hand = None if self._program is None else self._program.hand
        return max(self._device.heard_at_s, -math.inf if hand is None else hand.heard_at_s)

    def _explain(self, record: TickRecord, now_s: float) -> None:
        """Complain of a new reason to stand that no fault gives; one that holds on was explained as it came."""
        cause = () if record.decision.driving else (record.decision.cause,)
        reasons = frozenset((*cause, *record.guard_result.reasons)) - _ALWAYS - _LIMITS
        new, self._reasons = reasons - self._reasons, reasons
        for fault in self._begun:
            new -= because_of(fault.target, fault.kind)
        for point in self._story.points:
            new -= _BECAUSE.get(point, frozenset())
        if new and now_s - self._begun_s > _STARTS_S:
            self.told.problems.append(f"at {now_s:.2f} s: it stands because of {', '.join(sorted(new))}, why?")

    def _plan(self, event: Event) -> None:
        fault = event.fault()
        self._time.at(fault.begin_s, lambda: self._begin(fault))
        self._time.at(fault.end_s, lambda: self._end(fault))

    def _begin(self, fault: Fault) -> None:
        self.rig.injection.plan(fault)
        self.rig.ends.begin(fault)
        if all(each.end_s < fault.begin_s for each in self._begun):
            self._witness.watch()
        self._begun.append(fault)
        match fault.target, fault.kind:
            case "controller", "restart":
                self.rig.power_cycle()
                self.rig.injection.acted.add(fault)
            case "program", kind:
                self._ends = kind == "restart"
                self.rig.injection.acted.add(fault)
        if self._program is not None:
            self._program.begin_fault(fault)

    def _end(self, fault: Fault) -> None:
        self.rig.ends.finish(fault)
        self._judge(fault)
        if self._program is not None:
            self.told.problems += self._program.end_fault(fault)
        self.rig.injection.end(fault.target)
        self._time.at(fault.end_s + _LASTING_S, lambda: self._begun.remove(fault))

    def _judge(self, fault: Fault) -> None:
        """Complain unless the robot stood as the table demands, where nothing else failed and it drove before."""
        row = TABLE.cases.get(fault.target, {}).get(fault.kind)
        alone = all(each is fault or each.end_s < fault.begin_s - _LASTING_S for each in self._begun)
        # A disk stops it only by a lesson, a hand only one that drives.
        judged = row is not None and row.leads_to == "stands" and fault.target not in ("disk", "teacher_link")
        if row is None or not judged or not alone or self._begun_s > fault.begin_s - _DROVE_S:
            return
        witness, within_s = self._witness, row.latches_within_s or row.within_s or 0.0
        if row.latches == GuardReason.WHEELS_DISOBEY:
            within_s *= _MANOEUVRE  # until it is told to change its speed
        slowest = min(witness.slowest_m_s(fault.begin_s - _DROVE_S, fault.begin_s + within_s), 1.0)
        if slowest < _SHOWS_M_S or fault.end_s - fault.begin_s < within_s or not fault.acts(fault.begin_s):
            return
        if not witness.standstills(fault.begin_s, fault.end_s):
            self.told.problems.append(f"{fault}: it did not stand")
        latched = witness.latched
        if row.latches is not None and (latched is None or latched[0] > fault.begin_s + within_s + _ROUNDING_S):
            self.told.problems.append(f"{fault}: it was to be stopped because of {row.latches}, was {latched}")

    def _is_over(self) -> bool:
        return self._ends or self._time.now_s() >= self._story.lasts_s

    def _may_end(self) -> bool:
        """Return whether the fault of a clock or a tick is there, after which the program has to start again."""
        return any(
            fault.target in ("clock", "tick") and case_of(fault.target, fault.kind).must.ends_by == "restart"
            for fault in self._begun
        )

    def _set_free(self) -> None:
        """Put it where it can drive, as a person does."""
        self.rig.set_down()
        if self._program is not None:
            self._program.runtime.reposition()

    def _judge_saved(self) -> None:
        with Journal.read_only(self._folder / "drill.knowledge") as journal:
            stored = [entry.event.origin.command_id for entry in journal.iter_entries()]
        if lost := self._device.saved - set(stored):
            self.told.problems.append(f"{len(lost)} lessons that a teacher was told to be durable are gone")
        if len(set(stored)) != len(stored):
            self.told.problems.append("a lesson stands twice in the knowledge")


def _open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


async def tell(story: Story, folder: Path) -> Told:
    """Drive a story in an empty folder."""
    if story.taught:
        shutil.copy(await _knowledge(story.task), folder / "drill.knowledge")
    teller = _Teller(story, folder)
    with closing(teller.rig):
        return await teller.tell()


_known: dict[str, tuple[TemporaryDirectory[str], Path]] = {}


async def _knowledge(task: str) -> Path:
    """Return a knowledge file of a task, taught in a story in which nothing fails."""
    if task not in _known:
        folder = TemporaryDirectory()
        teaching = Teaching(phase=2, reaction_s=0.5, error_rate=0.0)
        story = Story(seed=_KNOWN_SEED, lasts_s=_KNOWN_S, task=task, teaching=teaching)
        told = await tell(story, Path(folder.name))
        assert not told.problems, told.problems
        _known[task] = folder, Path(folder.name) / "drill.knowledge"
    return _known[task][1]
