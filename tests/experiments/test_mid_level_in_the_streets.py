"""A mid level on the real path: simulated robot, bus, journal and service; the policy drives what it commands."""

from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest

from behaviors.repertoire import load_repertoire
from hal.health import Health
from kurt2rt.core.basic.policy_level import PolicyLevel
from kurt2rt.core.decision.decision import ActiveBehaviour
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Command, Correct, Teach
from kurt2rt.core.teaching.question import MidQuestion, Question
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import open_for_teaching
from kurt2rt.knowledge.journal.writer import Acknowledgement, JournalWriter
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import RuntimeOptions, build_runtime
from kurt2rt.service.assembly import RobotService
from kurt2rt.service.post_tick import PostTick, ProgramConsole, ProgramStatus
from kurt2rt.service.settings import load_service
from kurt2rt.service.status_line import status_line
from simbridge.robot_simulation import Kurt2Simulation
from tests.channel.channel_fixture import STAMP
from tests.experiments.helpers import ROBOT

STREETS = load_task("streets")
ROUTE = STREETS.model_copy(update={"name": "route", "system": "streets", "mid": "turns"})


class Service:
    """The robot in Manhattan and its knowledge file, from when the program is started until it ends."""

    def __init__(self, simulation: Kurt2Simulation, clock: LockstepClock, path: Path) -> None:
        opened = open_for_teaching(path, ROBOT, ROUTE)
        self.writer = JournalWriter(opened.journal, lambda: STAMP).start()
        self.settled: list[Acknowledgement] = []
        self.questions: list[Question | MidQuestion] = []
        wanted = ActiveBehaviour(ROUTE.behaviours)
        driver = PolicyLevel(ROUTE.policy.build(ROBOT.infrared), load_repertoire(ROUTE.repertoire, ROBOT), 10, wanted)
        self.runtime = build_runtime(
            simulation.robot,
            ROBOT,
            ROUTE,
            opened.events,
            self.writer,
            clock,
            RuntimeOptions(
                statistics=opened.counter, level_override=driver, active_behaviour=wanted, checkpoint=opened.saved
            ),
        )
        screen = ProgramConsole(status=lambda _: None, question=self.questions.append, acknowledged=self.settled.append)
        self.rounds = PostTick(RobotService(self.runtime, self.writer, load_service(), opened.stamps), screen)
        self.record: TickRecord
        self.health: Health = simulation.robot.health

    async def run(self, seconds: float, *commands: Command) -> TickRecord:
        """Run for `seconds`, or until a junction has been passed."""
        for command in commands:
            self.runtime.inbox.put(command)

        def after_tick(record: TickRecord) -> None:
            self.rounds(record)
            self.record = record
            if record.mid is not None and record.mid.event is not None:
                self.runtime.scheduler.end()

        await self.runtime.scheduler.run(round(seconds / ROBOT.cycle_s), after_tick)
        return self.record

    @property
    def line(self) -> str:
        return status_line(ProgramStatus(self.record, self.runtime, 0, None, ""), self.health)

    def close(self) -> None:
        self.rounds.save_statistics()
        self.writer.close()


@pytest.fixture
def simulation() -> Iterator[Kurt2Simulation]:
    with closing(Kurt2Simulation(ROBOT, "manhattan", 1, "exam")) as simulation:
        yield simulation


async def test_mid_level_asks_learns_and_continues_later(simulation: Kurt2Simulation, tmp_path: Path) -> None:
    path, clock = tmp_path / "streets.knowledge", LockstepClock(simulation.step)
    where_it_began = simulation.simulated_robot.pose
    with closing(Service(simulation, clock, path)) as first:
        await first.run(0.5)
        (question,) = first.questions
        assert isinstance(question, MidQuestion)
        assert (question.nearest_rla, question.here) == (None, ())
        assert "asks the way" in first.line

        record = await first.run(20.0, Teach("way-1", "Ann", "straight_on", level=MID))
        assert record.mid is not None
        assert record.mid.event is not None
        assert record.mid.event.quarters == 0
        assert "mid-level RLA 1" in first.line

        record = await first.run(20.0, Correct("way-2", "Ann", "turn_left", level=MID))
        assert record.mid is not None
        assert record.mid.event is not None
        assert record.mid.event.quarters == 1
        assert first.writer.flush(30.0)
        await first.run(0.05)
        assert [(each.command_id, each.error) for each in first.settled] == [("way-1", None), ("way-2", None)]

    simulation.simulated_robot.place(where_it_began)
    with closing(Service(simulation, clock, path)) as second:
        events = []
        for _ in range(2):
            record = await second.run(20.0)
            assert record.mid is not None
            assert record.mid.event is not None
            events.append((record.mid.event.quarters, record.mid.behaviour))
        assert events[0] == (0, "turn_left")
        assert events[1][0] == 1
        assert not second.runtime.snapshot().uses  # the policy drove, as a teacher would
