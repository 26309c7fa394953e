"""All four kinds of behaviours of the paper in one repertoire: RLAs whose action each of them is drive the robot."""

import math
from collections import defaultdict
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import partial

import anyio
import pytest
import yaml

from config import CONFIG_DIR
from hal.robot import STANDSTILL
from hal.simulation import Pose, Simulation
from kurt2rt.core.decision.decision import Decision, DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import ReplaceAction, Teach
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runtime import Runtime, build_runtime
from tests.core.basic.helpers import keep, with_repertoire
from tests.core.rla.helpers import created
from tests.experiments.helpers import ROBOT, STAGE, teach

ACTIONS = (
    "kind: motor, name: forward, left_m_s: 0.30, right_m_s: 0.30",
    "kind: keep_distance, name: along_left_wall, front_sensor: s1, back_sensor: s2, distance_m: 0.22, "
    "speed_m_s: 0.30, gain_per_m: 4.0",
    "kind: turn_by_angle, name: turn_round, angle_deg: 180, speed_m_s: 0.20",
    "kind: taught, name: straight_on, task: streets, behaviour: straight_on, knowledge: streets.knowledge",
    "kind: task, name: patrol, task: {folder}/patrol.yaml, knowledge: streets.knowledge",
)
WHEREVER = created(1, (0.0,) * 72, "forward", radius=1e9)


class Drive:
    """Distance, turn and decision causes of each action."""

    def __init__(self) -> None:
        self.way_m: defaultdict[str, float] = defaultdict(float)
        self.turned_deg: defaultdict[str, float] = defaultdict(float)
        self.causes: defaultdict[str, set[DecisionCause]] = defaultdict(set)
        self._pose: Pose | None = None
        self.last = Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, None)

    def note(self, simulation: Simulation, wanted: str, record: TickRecord) -> None:
        pose = simulation.pose
        before = self._pose or pose
        self.way_m[wanted] += math.hypot(pose.x_m - before.x_m, pose.y_m - before.y_m)
        self.turned_deg[wanted] += math.degrees(math.remainder(pose.heading_rad - before.heading_rad, math.tau))
        self.causes[wanted].add(record.decision.cause)
        self._pose = pose
        self.last = record.decision


@pytest.fixture(scope="module")
def complete(tmp_path_factory: pytest.TempPathFactory) -> TaskSettings:
    """Return a task with the whole repertoire; less than a minute of teaching in streets stands next to it."""
    folder = tmp_path_factory.mktemp("complete")
    streets = load_task("streets", changes={"teaching.supervised_s": "10.0", "teaching.corrections_s": "0.0"})
    taught = teach(folder / "streets.knowledge", streets)
    content = yaml.safe_load((CONFIG_DIR / "tasks" / "streets.yaml").read_text(encoding="utf-8"))
    content.update(name="patrol", system="streets", mid="turns")
    (folder / "patrol.yaml").write_text(yaml.safe_dump(content), encoding="utf-8")
    mid_level = created(taught.result.rlas[-1].rla_id + 1, (0.0,) * 12, "straight_on", level=MID, command_id="mid-1")
    keep(folder / "streets.knowledge", load_task(str(folder / "patrol.yaml")), mid_level)
    return with_repertoire(load_task("wall_following"), folder, *(each.format(folder=folder) for each in ACTIONS))


@contextmanager
def runtime_of(task: TaskSettings) -> Iterator[tuple[Runtime, Simulation]]:
    """Yield a robot in a street of Manhattan, and its simulation; its only RLA answers at any place."""
    simulation = STAGE.open("manhattan", 1, "all kinds")
    try:
        yield (
            build_runtime(
                simulation.robot, ROBOT, task, [WHEREVER], InMemoryEventStore(), LockstepClock(simulation.step)
            ),
            simulation,
        )
    finally:
        simulation.close()


async def let_drive(runtime: Runtime, action: str, seconds: float, see: Callable[[TickRecord], None]) -> None:
    """Replace the action of the RLA, then run for `seconds`."""
    runtime.inbox.put(ReplaceAction(f"now-{action}", "Ann", 1, action))
    await runtime.scheduler.run(round(seconds * 100), see)


def test_actions_of_all_kinds_drive(complete: TaskSettings) -> None:
    told = Drive()
    parts = {"patrol": 1.5, "straight_on": 1.5, "forward": 0.5, "along_left_wall": 1.0, "turn_round": 6.0}

    async def all_parts() -> None:
        for action, seconds in parts.items():
            await let_drive(runtime, action, seconds, partial(told.note, simulation, action))

    with runtime_of(complete) as (runtime, simulation):
        anyio.run(all_parts)
    assert {(action, *causes) for action, causes in told.causes.items()} == {
        (each, DecisionCause.RLA) for each in parts
    }
    assert told.way_m["patrol"] > 0.3
    assert told.way_m["straight_on"] > 0.4
    assert told.way_m["forward"] == pytest.approx(0.15, abs=0.02)
    assert told.turned_deg["along_left_wall"] > 30.0  # into the street that opens on its left
    assert told.turned_deg["turn_round"] == pytest.approx(180.0, abs=15.0)
    assert told.last.wheel_speeds == STANDSTILL  # the turn is finished


def test_lost_task_stands_and_asks_until_an_answer(complete: TaskSettings) -> None:
    asked: list[TickRecord] = []

    def until_it_asks(record: TickRecord) -> None:
        if record.decision.asking:
            asked.append(record)
        if len(asked) == 200:
            runtime.scheduler.end()

    answered: list[TickRecord] = []

    async def story() -> None:
        await let_drive(runtime, "patrol", 60.0, until_it_asks)
        runtime.inbox.put(Teach("answer", "Ann", "forward"))
        await runtime.scheduler.run(20, answered.append)

    with runtime_of(complete) as (runtime, simulation):
        anyio.run(story)
    last = asked[-1].decision
    assert asked[-1].tick - asked[0].tick == 199  # it does not drive on by itself
    assert (last.wheel_speeds, last.action) == (STANDSTILL, None)
    assert last.match is not None
    assert last.match.known
    assert [each.decision.action for each in answered] == ["forward"] * 20
    assert simulation.collisions == 0
