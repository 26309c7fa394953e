"""Drives a story: starts of the program one after the other, with faults, points and a teacher as it says."""

import asyncio
import ctypes
import random
import shutil
from collections import Counter
from contextlib import closing
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil

from hal import points
from hal.points import Point, never
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.verify import verify
from simbridge.worlds.world_loading import load_world
from tests.stories.device import Device
from tests.stories.program import KNOWLEDGE, Program
from tests.stories.rig import ROBOTS, Rig
from tests.stories.rules import LASTING_S, Rules
from tests.stories.story import CALM_S, Event, Story
from tests.stories.table import Fault, RobotKind
from tests.stories.teacher import StoryTeacher
from tests.stories.witness import Witness

_MINUTE_TICKS = 6000
_DOWN_S = (0.5, 3.0)
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
_KNOWN_SEED, _KNOWN_S = -1, 40.0  # of a story of that seed the commands would be those of before


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
        self._task: TaskSettings = load_task(story.named(story.task))
        robot = ROBOTS[story.robot]
        self.rig = Rig(robot, load_world(story.named(story.world), robot), self._chance("rig"))
        self._time = self.rig.time
        self._witness = Witness(self.rig)
        self._device = Device(self.rig.injection, self._chance("device"))
        self._program: Program | None = None
        self._rules = Rules(story, self._witness, self._device)
        self._ends = False
        self._rare, self._pauses = self._chance("points"), self._chance("pauses")
        for event in story.faults:
            self._plan(event)

    async def tell(self) -> Told:
        told, story = self.told, self._story
        while self._time.now_s() < story.lasts_s:
            await self._run_program()
            self._time.run_until(self._time.now_s() + self._pauses.uniform(*_DOWN_S))
        self._rules.on_end(self._folder / KNOWLEDGE)
        told.problems += self._rules.problems + self._witness.complaints
        told.acted = {str(each) for each in self.rig.injection.acted}
        digest = self._witness.digest
        digest.update("".join(sorted(self._device.saved)).encode())
        told.hash = digest.hexdigest()
        return told

    def _chance(self, part: str) -> random.Random:
        """Return the chance of a part, so that what one part draws changes nothing for the others."""
        return random.Random(f"{part} {self._story.seed}")

    def _happens(self, point: Point) -> bool:
        """Return whether something happens at a point of the program now; none does at the end."""
        if point not in self._story.points or self._time.now_s() >= self._story.lasts_s - CALM_S:
            return False
        happens = self._rare.random() < _OFTEN.get(point, _SOMETIMES)
        self.told.happened[point] += happens
        return happens

    async def _run_program(self) -> None:
        told, story = self.told, self._story
        files, tasks = _open_files(), len(asyncio.all_tasks())
        told.starts += 1
        self._time.run_until(self.rig.ends.back_at_s)  # no program starts without its bus
        self.rig.set_down()
        program = self._program = Program(
            self.rig,
            self._witness,
            self._device,
            self._folder,
            told.starts,
            self._chance(f"program {told.starts}"),
            task=self._task,
            records=story.records,
        )
        for fault in self._rules.begun:
            if fault.acts(self._time.now_s()):
                program.begin_fault(fault)  # it was under way before this start
        self._ends = False
        self._rules.on_start(self._time.now_s())
        chance = self._chance(f"teacher {told.starts}")
        teacher = StoryTeacher(program, self._task, story.teaching, chance)
        points.happens = self._happens
        try:
            await program.run(lambda record: self._after_tick(program, teacher, record), self._is_over)
        finally:
            points.happens = never
        told.ticks += program.runtime.timer.ticks
        told.lessons += len(program.knowledge.submitted)
        if program.ended_by:
            self._rules.on_error(program.ended_by)
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

    def _after_tick(self, program: Program, teacher: StoryTeacher, record: TickRecord) -> None:
        now_s = self._time.now_s()
        if not teacher.is_calm and now_s >= self._story.lasts_s - CALM_S:
            teacher.is_calm = True
            program.set_down()
            self._rules.set_down_s = now_s
        for command in teacher.update(record):
            self._device.send(command)
        if record.number % _MINUTE_TICKS == 0:
            ctypes.CDLL(None).malloc_trim(0)
            self.told.resident_mb.append(psutil.Process().memory_info().rss / 1e6)
        self._rules.on_tick(record, now_s, unsaved_s=program.knowledge.must_stand_since_s)

    def _plan(self, event: Event) -> None:
        fault = event.fault()
        self._time.at(fault.begin_s, lambda: self._begin(fault))
        self._time.at(fault.end_s, lambda: self._end(fault))

    def _begin(self, fault: Fault) -> None:
        self.rig.injection.plan(fault)
        self.rig.ends.begin(fault)
        self._rules.on_fault(fault)
        match fault.target, fault.kind:
            case "controller" | "serial" | "topics", "restart":
                self.rig.power_cycle()
                self.rig.injection.acted.add(fault)
            case "program", kind:
                self._ends = kind == "restart"
                self.rig.injection.acted.add(fault)
        if self._program is not None:
            self._program.begin_fault(fault)

    def _end(self, fault: Fault) -> None:
        self.rig.ends.finish(fault)
        self._rules.on_fault_over(fault)
        if self._program is not None:
            self.told.problems += self._program.end_fault(fault)
        self.rig.injection.end(fault.target)
        self._time.at(fault.end_s + LASTING_S, lambda: self._rules.begun.remove(fault))

    def _is_over(self) -> bool:
        return self._ends or self._time.now_s() >= self._story.lasts_s


def _open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


async def tell(story: Story, folder: Path) -> Told:
    """Drive a story in an empty folder."""
    if story.taught:
        shutil.copy(await _knowledge(story.robot, story.task), folder / KNOWLEDGE)
    teller = _Teller(story, folder)
    with closing(teller.rig):
        return await teller.tell()


_known: dict[tuple[RobotKind, str], tuple[TemporaryDirectory[str], Path]] = {}


async def _knowledge(robot: RobotKind, task: str) -> Path:
    """Return a knowledge file of a task, taught in a story in which nothing fails."""
    if (robot, task) not in _known:
        folder = TemporaryDirectory()
        told = await tell(Story(seed=_KNOWN_SEED, lasts_s=_KNOWN_S, robot=robot, task=task), Path(folder.name))
        assert not told.problems, told.problems
        _known[robot, task] = folder, Path(folder.name) / KNOWLEDGE
    return _known[robot, task][1]
