"""Work of the service after each tick, with a real journal and its thread, on ticks that the test makes."""

from collections.abc import Iterator
from pathlib import Path

import pytest

from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.events import RlaCreated, RlaDeleted
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.teaching.commands import Command, Teach
from kurt2rt.core.teaching.inbox import RobotRepositioned
from kurt2rt.core.teaching.question import MidQuestion, Question
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, RuntimeOptions, build_runtime
from kurt2rt.service.assembly import RobotService
from kurt2rt.service.post_tick import PostTick, ProgramConsole, ProgramStatus
from kurt2rt.service.settings import load_service
from tests.channel.channel_fixture import ROBOT, STAMP, TASK, ChannelFixture, WideRobot
from tests.core.rla.helpers import created, origin

CHECKPOINT, SECOND = 50, 100
SERVICE = load_service().model_copy(update={"checkpoint_period_s": 0.5, "status_period_s": 2.0})


class Shift:
    """A robot, its journal on a real disk, and the rounds that are made after each of its ticks."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.writer = JournalWriter(open_for_teaching(path, ROBOT, TASK).journal, lambda: STAMP).start()
        self.desk = ChannelFixture(keeper=self.writer)
        self.stamps: dict[str, str] = {}
        self.statuses: list[ProgramStatus] = []
        self.questions: list[Question | MidQuestion] = []
        self.settled: list[Acknowledgement] = []
        self.seen: list[TickRecord] = []
        self.next_command: Command | None = None
        screen = ProgramConsole(
            status=self.statuses.append, question=self.questions.append, acknowledged=self.settled.append
        )
        self.rounds = PostTick(
            RobotService(self.desk.runtime, self.writer, SERVICE, self.stamps), screen, on_tick=self._watch
        )
        self._tick = 10_000

    def run(self, ticks: int = 1, counts: int | None = None) -> TickRecord:
        """So many ticks, as the scheduler makes them."""
        if counts is not None:
            self.desk.robot.counts = counts
        runtime = self.desk.runtime
        for _ in range(ticks):
            self._tick += 1
            runtime.timer.begin(0.0)
            record = runtime.tick.run(self._tick, self._tick * 0.01)
            self.rounds(record)
            runtime.timer.end()
        return record

    def write(self) -> None:
        """Wait until everything is on disk."""
        assert self.writer.flush(30.0)

    def _watch(self, record: TickRecord) -> Command | None:
        self.seen.append(record)
        command, self.next_command = self.next_command, None
        return command


@pytest.fixture
def shift(tmp_path: Path) -> Iterator[Shift]:
    shift = Shift(tmp_path / "lessons.knowledge")
    yield shift
    shift.writer.close()


def test_post_tick_lost_lesson_has_no_stamp(shift: Shift) -> None:
    shift.desk.runtime.inbox.put(Teach("t-1", "Ann", "forward"))
    shift.run()
    shift.writer.submit(RlaDeleted(1, origin("t-1")))  # the same command cannot have done something else as well
    shift.write()
    shift.run()
    good, bad = shift.settled
    assert (good.error, bad.command_id, bad.sequence) == (None, "t-1", None)
    assert "row 1" in str(bad.error)
    assert shift.stamps == {"t-1": STAMP}


def knows(shift: Shift, rla_id: int) -> RlaCreated:
    """One RLA, far from where the robot is."""
    runtime = shift.desk.runtime
    event = created(rla_id, (1e6,) * runtime.level.system.dimensions)
    runtime.handler.updater.apply(event)
    return event


def test_counts_are_saved_once_per_checkpoint(shift: Shift) -> None:
    knows(shift, 7)
    shift.desk.runtime.statistics.uses[7] = 3
    shift.run(CHECKPOINT - 1)
    shift.write()
    assert saved_uses(shift) == {}
    shift.run(1)
    shift.desk.runtime.statistics.uses[7] = 99  # what was handed over does not change any more
    shift.write()
    assert saved_uses(shift) == {7: 3}
    shift.rounds.save_statistics()
    shift.write()
    assert saved_uses(shift) == {7: 99}


def test_post_tick_values_are_saved_and_restored(shift: Shift) -> None:
    taught = knows(shift, 7)
    shift.desk.runtime.reinforcement.rule.restore(Statistics(values={7: -0.25}))
    shift.run(CHECKPOINT)
    shift.write()
    with Journal.read_only(shift.path) as journal:
        saved = journal.statistics()
    assert saved.values == {7: -0.25}
    again = runtime_from(saved, taught)
    assert again.reinforcement.value(7) == -0.25


def runtime_from(saved: Statistics, *events: RlaCreated) -> Runtime:
    """Return the runtime of the next start of the program."""
    clock = LockstepClock(lambda: None)
    return build_runtime(
        WideRobot(), ROBOT, TASK, events, InMemoryEventStore(), clock, RuntimeOptions(checkpoint=saved)
    )


def test_post_tick_question_comes_once(shift: Shift) -> None:
    shift.desk.runtime.inbox.put(RobotRepositioned())
    shift.run(3 * SECOND)
    (question,) = shift.questions
    assert isinstance(question, Question)
    assert question.nearest_rla is None


def saved_uses(shift: Shift) -> dict[int, int]:
    with Journal.read_only(shift.path) as journal:
        return dict(journal.statistics().uses)
