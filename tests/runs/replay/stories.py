"""Runs to be recorded and replayed: some minutes of a robot that is taught, in lockstep.

`python -m tests.runs.replay.stories` makes the stored runs again.
"""

import asyncio
import math
import sys
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from tempfile import TemporaryDirectory

from mcap.writer import CompressionType, Writer

from hal.kurt2_settings import load_kurt2
from hal.robot import Robot
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.decision.goal import NamedGoal
from kurt2rt.core.decision.standing import STARTED, ActiveStop
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    Drive,
    EndSession,
    Resume,
    Reward,
    RunBehaviour,
    Seek,
    SetPhase,
    Stop,
    Undo,
    Watch,
)
from kurt2rt.core.teaching.inbox import PairingRenewed
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.navigation.guided_tour import HOME, TourGuide, navigation_settings
from kurt2rt.knowledge.exchange.attachments import collect_attachments, hash_attachments
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runs.recording.recorder import RunRecorder, open_run_recorder
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.runs.recording.run_head import RUN_METADATA, RecordedRun, RunHead
from kurt2rt.runs.recording.segment_reader import SegmentReader
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from kurt2rt.teacher.scripted.basic_teacher import BasicTeacher, view_of_tick
from kurt2rt.teacher.scripted.build import build_teacher
from simbridge.robot_simulation import Kurt2Simulation
from tests.runs.replay.stored_runs import STORED

NAME = "scripted teacher"
_STARTED_NS = 1_774_000_000_000_000_000
_SAVED_EVERY = 100
"""Ticks from one save of the statistics to the next."""


@dataclass
class Scene:
    """A robot that runs, its simulation and its teacher."""

    simulation: Kurt2Simulation
    runtime: Runtime
    notebook: InMemoryEventStore
    teacher: BasicTeacher
    said: int = 0
    presses: int = 0
    home: list[object] = field(default_factory=list)

    def say(self, make: Callable[[str], Command]) -> None:
        """Send a command with a new id."""
        self.said += 1
        self.runtime.inbox.put(make(f"story-{self.said}"))

    def let_teach(self, record: TickRecord) -> None:
        """Let the teacher say what it has to say after a tick."""
        command = self.teacher.update(view_of_tick(record))
        if command is not None:
            self.runtime.inbox.put(command)


Story = Callable[[Scene, TickRecord], None]


def at(second: float) -> int:
    """Return the tick at that time."""
    return round(second * 100)


def walls(scene: Scene, record: TickRecord) -> None:
    """Drive along a wall through all five phases, with the commands of a nervous teacher."""
    tick, runtime, say = record.tick, scene.runtime, scene.say
    if tick % 5 == 0 and not at(20) < tick < at(21):  # for a second his line is dead
        runtime.inbox.put(Watch(NAME, tick))
    if tick < at(35):
        scene.let_teach(record)
    scene.notebook.saving_error = "the disk is full" if at(14) <= tick < at(14.4) else None
    if at(22) <= tick < at(23):
        runtime.inbox.put(Drive(NAME, tick, 1, 0.1, 0.2))
    match tick:
        case 10:
            say(lambda name: BeginSession(name, NAME, "walls"))
        case 600 | 2150 | 2350 | 2900:
            say(lambda name: Resume(name, NAME))
        case 570:
            say(lambda name: Stop(name, NAME))
        case 1000:
            runtime.inbox.put(scene.teacher.begin_phase(Phase.CORRECTIONS))
        case 1700 | 1900:
            say(lambda name: Undo(name, NAME))
        case 2400:
            runtime.inbox.put(PairingRenewed(NAME))
        case 2800:
            say(lambda name: RunBehaviour(name, NAME, "curve_left", 60))
        case 3000:
            say(lambda name: SetPhase(name, NAME, Phase.REINFORCEMENT))
        case 3100 | 3200 | 3250 | 3300:
            say(lambda name: Reward(name, NAME, -1 if tick > 3150 else 1, tick - 30))
        case 3500:
            say(lambda name: SetPhase(name, NAME, Phase.CRITIC))
        case 3850:
            say(lambda name: SetPhase(name, NAME, Phase.AUTONOMOUS))
        case 4350:
            say(lambda name: EndSession(name, NAME))
    if at(35) <= tick < at(38.5) and tick % 25 == 0:
        opinions = ("bad", "neutral", "good")
        say(lambda name: Appraise(name, NAME, opinions[tick // 25 % 3], tick - 10))


class Errand:
    """Led about in a town, and then sent home."""

    def __init__(self, scene: Scene, task: TaskSettings) -> None:
        self._walk = navigation_settings(task).walk_in(scene.simulation.plan, task.behaviours)
        self._guide = TourGuide(self._walk, 5, scene.teacher.times, period_s=0.01, seed=3, session="errand")
        self._walk.reset(scene.simulation.pose)
        self._guide.begin()
        scene.runtime.inbox.put(scene.teacher.begin_phase(Phase.CORRECTIONS))
        self._home = scene.simulation.pose

    def __call__(self, scene: Scene, record: TickRecord) -> None:
        tick, inbox = record.tick, scene.runtime.inbox
        self._walk.update(scene.simulation.pose)
        said = self._guide.watch(record) if tick < at(34) else None
        if said is not None:
            inbox.put(said)
        scene.let_teach(record)
        if tick == at(22):
            scene.simulation.put(self._home)
            scene.runtime.reposition()
            self._walk.reset(self._home)
            self._guide.set_down_at_home()
        if tick == at(34):
            scene.say(lambda name: Seek(name, NAME, NamedGoal(HOME)))


@dataclass(frozen=True)
class Told:
    """Task, seed and script of a story."""

    task: str
    seconds: float
    attended: bool = False
    stopped: ActiveStop | None = None


STORIES = {"walls": Told("wall_following", 44, attended=True, stopped=STARTED), "errand": Told("errands", 44)}


def record_story(
    name: str,
    recordings: Path,
    *,
    seconds: float | None = None,
    task: TaskSettings | None = None,
    other: Story | None = None,
    faulty: Callable[[Robot], Robot] = lambda robot: robot,
    saved: Statistics | None = None,
) -> Path:
    """Let a story happen, or an`other` one in its place, and record it; the run's folder.

    `faulty`: puts a fault between the robot and its mind. `saved`: statistics that the run begins with.
    """
    told = STORIES[name]
    settings, task = load_kurt2(), task or load_task(told.task)
    simulation = Kurt2Simulation(settings, task.teaching.world, 3, f"story {name}")
    notebook = InMemoryEventStore()
    clock = LockstepClock(simulation.step)
    attachments = collect_attachments(settings, task, (), saved)
    head = RunHead(
        kurt2rt="story",
        boot="00",
        started_at="2026-03-20T09:46:40Z",
        task=task.name,
        robot=settings.name,
        bus="sim",
        knowledge="",
        attended=told.attended,
        asked=True,
        stopped=told.stopped.reason if told.stopped else "",
        behaviour=task.behaviours[0],
        fingerprints=hash_attachments(attachments),
    )
    wanted = ActiveBehaviour(task.behaviours)
    runtime = build_runtime(
        faulty(simulation.robot),
        settings,
        task,
        (),
        notebook,
        clock,
        RuntimeOptions(attended=told.attended, active_behaviour=wanted, checkpoint=saved),
    )
    if told.stopped:
        runtime.handler.control.stop(told.stopped)
    teacher = build_teacher(task, settings, tuple(runtime.level.repertoire), seed=3, session=name)
    scene = Scene(simulation, runtime, notebook, teacher)
    story: Story = other or (walls if name == "walls" else Errand(scene, task))
    names = runtime.definition.names
    run = RecordedRun(f"story-{name}", head, attachments, settings, names, began_at_ns=_STARTED_NS)
    recorder = open_run_recorder(recordings, run, budget_of(1000))
    _go(scene, story, recorder, round((seconds or told.seconds) * 100))
    assert recorder.run is not None
    assert not recorder.trouble
    return recorder.run


def _go(scene: Scene, story: Story, recorder: RunRecorder, ticks: int) -> None:
    runtime = scene.runtime
    recorder.poll()

    def after_tick(record: TickRecord) -> None:
        story(scene, record)
        saved = record.tick % _SAVED_EVERY == 0
        if saved:
            runtime.snapshot()
            recorder.write_waiting()
            recorder.poll()
        recorder.on_tick(record, saved=saved)

    try:
        asyncio.run(runtime.scheduler.run(ticks, after_tick))
    finally:
        scene.simulation.close()
    recorder.close()


def slim(segment: Path, to: Path, seconds: float = math.inf) -> None:
    """Only what a replay needs of a run's first segment, of so many seconds of it, in one file."""
    with to.open("wb") as file:
        writer = Writer(file, compression=CompressionType.ZSTD, chunk_size=1 << 24)
        writer.start(profile="kurt2rt")
        reader = SegmentReader(segment)
        head = reader.head()
        writer.add_metadata(RUN_METADATA, head.metadata[RUN_METADATA])
        for name, data in head.attachments.items():
            writer.add_attachment(0, 0, name, "application/octet-stream", data)
        channel = writer.register_channel("/tick", "json", 0)
        for message in islice(reader.messages({"/tick"}), None if math.isinf(seconds) else at(seconds)):
            writer.add_message(channel, message.time_ns, message.data, message.time_ns)
        writer.finish()  # type: ignore[no-untyped-call]


def main() -> None:
    """Make the stored runs again."""
    STORED.mkdir(exist_ok=True)
    for name in sys.argv[1:] or STORIES:
        with TemporaryDirectory() as folder:
            run = record_story(name, Path(folder))
            slim(run / "0001.mcap", STORED / f"{name}.mcap")
        sys.stdout.write(f"{name}: {(STORED / name).with_suffix('.mcap').stat().st_size} bytes\n")


if __name__ == "__main__":
    main()
