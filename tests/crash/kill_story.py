"""A robot program is killed at any moment of its life, over and over, while a teacher teaches it over the network.

The robot is a program of its own on a shared bus, and goes on. After each kill it stands by its own watchdog, every
lesson that was acknowledged is in the knowledge file once, its recording can be read and replayed, and the next program
asks before it drives.
"""

import random
import secrets
import time
from collections import Counter
from contextlib import ExitStack
from dataclasses import dataclass, field, fields
from pathlib import Path

import anyio
import anyio.abc
import anyio.to_thread
import can

from hal.bus import CanBus, open_bus
from hal.robot_settings import load_robot
from kurt2rt.channel.protocol.limits import COMMAND_ID_BYTES
from kurt2rt.channel.protocol.requests import Request, tick_request
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Correct, Resume, Reward, SetPhase, Take, Teach, Undo
from kurt2rt.knowledge.journal.entry import JournalEntry
from kurt2rt.knowledge.journal.fold import check_knowledge
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.teacher.client.answer import NoAnswerError
from kurt2rt.teacher.client.client import TeacherClient
from tests.cli.three_programs import BRAKING_CYCLES, WATCHDOG_CYCLES, drives, is_control, stands, turns
from tests.crash.killed_recording import KilledRecordings
from tests.crash.programs import Program

ACTIONS = ("forward", "forward", "back", "spin_left", "whirl_right")
LONGEST_S = 600.0
"""Fails a story whose event never comes."""
YOUNGEST_SHARE = 0.3
"""Share of programs that are killed while they start."""
START_S = 0.6
"""Assumed duration of a start, until one was measured on this machine."""
DRIVING_SHARE = 0.6
"""Share of the other programs that are killed only after the robot drives by a taught RLA."""
IN_A_LESSON_SHARE = 0.4
"""Share of the other programs that are killed soon after the next lesson is sent."""
MOST_INTO_A_LESSON_S = 0.03
"""Typical time from sending a lesson to its acknowledgement."""
LONGEST_LIFE_S = 1.5
MOST_LESSONS = 5
REPLAYED_EVERY = 3
MOST_FURTHER_S = 0.4
CYCLE_S = load_robot().cycle_s
_TOO_MANY_CYCLES = 10 * (WATCHDOG_CYCLES + BRAKING_CYCLES)
_LOOK_S = 0.005


@dataclass
class Tally:
    """Counts over many kills."""

    kills: int = 0
    young: int = 0
    """Killed while they started."""
    driving: int = 0
    """Killed while the wheels turned."""
    asked: int = 0
    """Killed after a lesson was sent and before its teacher was answered."""
    acknowledged: int = 0
    stored: int = 0
    """Lessons in the file in the end."""
    unacknowledged: int = 0
    """Lessons in the file that the teacher got no answer for."""
    most_cycles_to_rest: int = 0
    recorded_ticks: int = 0
    """Ticks that can be read from the recordings."""
    unreadable: int = 0
    """Recordings that ended before the first second was on the disk."""
    most_unrecorded_s: float = 0.0
    """Longest time from the last recorded tick to the kill."""
    replayed: int = 0
    """Recordings that were replayed, bit for bit."""
    kinds: Counter[str] = field(default_factory=Counter)
    """Acknowledged lessons by kind."""

    def add(self, more: "Tally") -> None:
        """Add the counts of further kills; keep the larger of each maximum."""
        for each in fields(self):
            mine, others = getattr(self, each.name), getattr(more, each.name)
            setattr(self, each.name, max(mine, others) if each.name.startswith("most_") else mine + others)

    def __str__(self) -> str:
        kinds = ", ".join(f"{count} {kind}" for kind, count in sorted(self.kinds.items()))
        return (
            f"{self.kills} kills ({self.young} while it started, {self.driving} while it drove, "
            f"{self.asked} while a lesson was on its way), "
            f"{self.acknowledged} lessons acknowledged ({kinds}), "
            f"{self.stored} stored, {self.unacknowledged} of them unacknowledged; "
            f"at most {self.most_cycles_to_rest} cycles to rest; {self.recorded_ticks} ticks recorded, "
            f"{self.unreadable} recordings ended at their beginning, at most {self.most_unrecorded_s:.2f} s "
            f"are missing at an end, {self.replayed} were replayed bit for bit"
        )


class Life:
    """Teacher's commands and answers during one run of the robot program."""

    def __init__(self, we: TeacherClient, chance: random.Random) -> None:
        self._we = we
        self._chance = chance
        self.told: dict[int, tuple[str, str]] = {}
        """Command id and kind of the lesson of each row that was acknowledged."""
        self.asks = False
        """Whether a lesson is sent and not answered yet."""
        self._next_lesson = anyio.Event()

    @property
    def drives(self) -> bool:
        """Return whether the robot drove in the newest state."""
        state = self._we.state
        return state is not None and state.rla is not None and abs(state.left_m_s) + abs(state.right_m_s) > 0.1

    async def next_lesson(self) -> None:
        """Wait until one is sent."""
        await self._next_lesson.wait()

    async def teach(self) -> None:
        """Go on for ever: take, resume, answer, correct, praise, undo."""
        async for state in self._we.states():
            try:
                await self._react(state)
            except NoAnswerError:
                continue

    async def _react(self, state: State) -> None:
        if state.teacher != self._we.name:
            await self._we.send(Take)
        elif state.stopped:
            await self._we.send(Resume)
        elif state.cause == "unknown":
            await self._lesson(state, "answer")
        elif state.phase == Phase.SUPERVISED and self._chance.random() < 0.2:
            await self._we.send(SetPhase, phase=Phase.CORRECTIONS)
        elif state.rla is not None and state.phase == Phase.CORRECTIONS and self._chance.random() < 0.4:
            await self._lesson(state, self._chance.choice(["correct", "correct", "correct", "undo"]))
        elif self._chance.random() < 0.04:
            await self._we.send(SetPhase, phase=self._chance.choice([Phase.SUPERVISED, Phase.REINFORCEMENT]))
        elif state.rla is not None and state.phase == Phase.REINFORCEMENT and self._chance.random() < 0.4:
            await self._lesson(state, "reward")

    async def _lesson(self, state: State, kind: str) -> None:
        command_id, action = secrets.token_bytes(COMMAND_ID_BYTES), self._chance.choice(ACTIONS)
        boot, tick = state.boot, state.tick
        request: Request
        match kind:
            case "answer":
                request = tick_request(Teach, boot, command_id, tick, action=action, decision_tick=tick)
            case "correct":
                request = tick_request(Correct, boot, command_id, tick, action=action, decision_tick=tick)
            case "reward":
                value = self._chance.choice([-1, 1])
                request = tick_request(Reward, boot, command_id, tick, value=value, decision_tick=tick)
            case _:
                request = tick_request(Undo, boot, command_id, tick, lesson=None)
        self._next_lesson.set()
        self._next_lesson = anyio.Event()
        self.asks = True
        try:
            answer = await self._we._open.sender.send(request)
        finally:
            self.asks = False
        row = answer.extra.get("row")
        if answer.accepted and row is not None:
            self.told[row] = (f"{self._we.name}-{command_id.hex()}", kind)


class KillStory:
    """The robot, its bus, and one knowledge file for all the lives of its program."""

    def __init__(self, folder: Path, bus: str, seed: int, *words: str, longest_life_s: float = LONGEST_LIFE_S) -> None:
        """`words`: further options of `kurt2rt run`. `longest_life_s`: killed then, however few lessons there were."""
        self.tally = Tally()
        self._folder = folder
        self._bus_name = bus
        self._words = words
        self._longest_life_s = longest_life_s
        self._chance = random.Random(seed)
        self._knowledge = folder / "knowledge"
        self._rows: list[JournalEntry] = []
        self._acknowledged: set[int] = set()
        self._recordings = KilledRecordings(folder / "runs")
        self._start_s = START_S

    async def run(self, kills: int) -> Tally:
        """Kill so many programs. Raises AssertionError for what must not be."""
        with ExitStack() as ending:
            log = self._folder / "sim.log"
            sim = ending.enter_context(Program("sim", "--bus", self._bus_name, folder=self._folder, log=log))
            await sim.says("is on bus")
            self._bus: CanBus = open_bus(self._bus_name)
            ending.callback(self._bus.shutdown)
            for _ in range(kills):
                with anyio.fail_after(LONGEST_S):
                    await self._one_life()
                assert sim.lives, sim.said
        return self.tally

    async def _one_life(self) -> None:
        log = self._folder / "run.log"
        log.unlink(missing_ok=True)
        began_s = time.monotonic()
        words = ("--bus", self._bus_name, "--port", "0", "--knowledge", str(self._knowledge), "--record", "runs")
        with Program("run", *words, *self._words, folder=self._folder, log=log) as program:
            told: dict[int, tuple[str, str]] = {}
            if self._chance.random() < YOUNGEST_SHARE:
                self.tally.young += 1
                await anyio.sleep(self._chance.uniform(0.0, self._start_s))
                before = self._heard()
                await program.killed()
            else:
                line = await program.says("teachers are listened to on UDP port")
                self._start_s = time.monotonic() - began_s
                told, before = await self._taught_and_killed(program, int(line.split()[-1]))
        killed_at_s = time.monotonic()
        assert "Traceback" not in program.said, program.said
        self.tally.kills += 1
        self.tally.driving += any(turns(frame) for frame in before[-4:])
        await self._comes_to_rest()
        self._look_at_the_knowledge(told)
        await anyio.to_thread.run_sync(self._look_at_the_recording, killed_at_s)

    async def _taught_and_killed(
        self, program: Program, port: int
    ) -> tuple[dict[int, tuple[str, str]], list[can.Message]]:
        async with TeacherClient(self._folder / "var/devices/local", port=port) as we:
            life = Life(we, self._chance)
            state = await we._stream.first()
            assert state is not None
            assert state.stopped == STARTED
            assert not any(map(drives, self._heard())), "it drove before anybody had told it to"
            async with anyio.create_task_group() as tasks:
                tasks.start_soon(life.teach)
                lessons, further_s = self._chance.randint(0, MOST_LESSONS), self._chance.uniform(0, MOST_FURTHER_S)
                in_a_lesson = self._chance.random() < IN_A_LESSON_SHARE
                while_driving = self._chance.random() < DRIVING_SHARE
                until_s = time.monotonic() + self._longest_life_s
                while len(life.told) < lessons or (while_driving and not life.drives):
                    await anyio.sleep(_LOOK_S)
                    assert program.lives, program.said
                    if time.monotonic() > until_s:
                        break
                if in_a_lesson:
                    with anyio.move_on_after(MOST_FURTHER_S):
                        await life.next_lesson()
                    further_s = self._chance.uniform(0, MOST_INTO_A_LESSON_S)
                await anyio.sleep(further_s)
                before = self._heard()
                self.tally.asked += life.asks
                await program.killed()
                tasks.cancel_scope.cancel()
        return life.told, before

    def _heard(self) -> list[can.Message]:
        return self._bus.drain()

    async def _comes_to_rest(self) -> None:
        """Wait until the controller's own watchdog has stopped the wheels, with the program gone."""
        cycles: list[bool] = []
        while len(cycles) <= WATCHDOG_CYCLES or cycles[-1]:
            for frame in self._heard():
                if is_control(frame):
                    cycles.clear()  # some that the program sent before came late
                elif turns(frame) or stands(frame):
                    cycles.append(turns(frame))
            # Of a story that had to wait for a processor many cycles come at once, most of them at rest.
            assert len(cycles) < _TOO_MANY_CYCLES or not cycles[-1], "it did not come to rest"
            await anyio.sleep(CYCLE_S)
        cycles_to_rest = max((number for number, turning in enumerate(cycles, start=1) if turning), default=0)
        assert cycles_to_rest <= WATCHDOG_CYCLES + BRAKING_CYCLES
        self.tally.most_cycles_to_rest = max(self.tally.most_cycles_to_rest, cycles_to_rest)

    def _look_at_the_recording(self, killed_at_s: float) -> None:
        replayed = self.tally.kills % REPLAYED_EVERY == 0
        recording = self._recordings.newest(replayed=replayed)
        if recording is None:
            return
        if not recording.ticks:
            self.tally.unreadable += 1
            return
        self.tally.replayed += replayed
        self.tally.recorded_ticks += recording.ticks
        self.tally.most_unrecorded_s = max(self.tally.most_unrecorded_s, killed_at_s - recording.until_s)

    def _look_at_the_knowledge(self, told: dict[int, tuple[str, str]]) -> None:
        if not self._knowledge.exists():  # killed before it was born
            assert not self._rows
            assert not told
            return
        with Journal.read_only(self._knowledge) as journal:
            assert check_knowledge(journal) == []
            rows = journal.entries()
        assert rows[: len(self._rows)] == self._rows, "what stood there has changed"
        ids = [row.event.origin.command_id for row in rows]
        assert len(set(ids)) == len(ids), "a lesson stands there twice"
        for row, (command_id, kind) in told.items():
            assert row <= len(rows), f"row {row} was acknowledged, and is lost"
            assert ids[row - 1] == command_id
            self.tally.kinds[kind] += 1
        self.tally.acknowledged += len(told)
        self._acknowledged |= told.keys()
        self._rows = rows
        self.tally.stored = len(rows)
        self.tally.unacknowledged = len(rows) - len(self._acknowledged)
