"""Robot over a poor cable: it drives on, and equal seeds give equal runs."""

import random
from collections.abc import Callable
from contextlib import closing
from typing import NamedTuple

import can
import pytest

from hal.bus import CONTROL_ID, CanBus
from hal.robot import GuardResult, WheelSpeeds
from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.lockstep.exam import ExamSetup, examine
from simbridge.links import CanLine
from simbridge.robot_simulation import Kurt2Simulation
from tests.simbridge.rig import ROBOT
from tests.stories.cable import Cable, CableInterface

TURN = WheelSpeeds(0.2, -0.2)
TICK_S = ROBOT.cycle_s
PHASE_S = 0.005


class CableFaults(NamedTuple):
    """Longest time on the way in s, in which none overtakes another, and probability of a loss for each receiver."""

    delay_s: float = 0.0
    lost: float = 0.0


SOUND, LOSSY = CableFaults(), CableFaults(lost=0.1)


class PoorCable(Cable):
    """Cable with faults; equal seeds give equal ones."""

    def __init__(self, now_s: Callable[[], float], faults: CableFaults, chance: random.Random) -> None:
        super().__init__(now_s)
        self._faults, self._chance, self._carried_at_s = faults, chance, 0.0

    def carry(self, frame: can.Message, sender: CableInterface) -> None:
        at_s = self.now_s() + self._chance.uniform(0.0, self._faults.delay_s)
        self._carried_at_s = max(self._carried_at_s, at_s)
        super().carry(frame, sender)

    def deliver(self, frame: can.Message, end: CableInterface, *, own: bool) -> None:
        if own or self._chance.random() >= self._faults.lost:
            end.deliver(frame, self._carried_at_s, own=own)


class CableLine(CanLine):
    """Line over a cable; the notebook's tick comes half a cycle after the robot's."""

    def __init__(self, faults: CableFaults, seed: int = 1) -> None:
        self._now_s = 0.0
        cable = PoorCable(lambda: self._now_s, faults, random.Random(seed))
        ends = (CanBus("cable", lambda _: cable.join(CableInterface(cable))) for _ in range(2))
        self.robot_end, self.notebook_end = ends
        self.robot_end.set_id_filter({CONTROL_ID})

    def cycle(self, step_robot: Callable[[], None]) -> None:
        self._now_s += TICK_S - PHASE_S
        step_robot()
        self._now_s += PHASE_S


async def policy_drives(open_line: Callable[[], CanLine], seed: int = 1, seconds: float = 1.5, world: str = "a") -> str:
    """Let the teacher's policy drive without a stop by the bus, and return the hash of the last state."""
    task = load_task("wall_following")
    task = task.model_copy(update={"exam": task.exam.model_copy(update={"duration_s": seconds})})
    with closing(Kurt2Simulation(ROBOT, world, seed, "exam", open_line=open_line)) as simulation:
        result = await examine(simulation, ROBOT, task, ExamSetup(world, seed, teacher_policy=True), lambda _: None)
        assert simulation.robot.health.latched is None
        assert (result.collisions, result.stuck) == (0, False)
        return simulation.simulated_robot.state_hash()


async def test_sound_cable_equals_the_bus_in_memory_to_the_last_bit() -> None:
    """All telemetry of a cycle arrives before the tick, and CONTROL before the next cycle."""
    in_memory = await policy_drives(CanLine)
    assert await policy_drives(lambda: CableLine(SOUND)) == in_memory
    assert await policy_drives(lambda: CableLine(CableFaults(delay_s=0.004))) == in_memory


async def test_lossy_cable_same_seed_gives_the_same_run() -> None:
    first = await policy_drives(lambda: CableLine(LOSSY, seed=3))
    assert await policy_drives(lambda: CableLine(LOSSY, seed=3)) == first
    assert await policy_drives(lambda: CableLine(LOSSY, seed=4)) != first


def test_robot_over_a_lossy_cable_keeps_turning() -> None:
    with closing(Kurt2Simulation(ROBOT, "a", 1, "cable", open_line=lambda: CableLine(LOSSY))) as simulation:
        grants: list[GuardResult] = []
        for tick in range(1, 701):
            simulation.step()
            now_s = tick * TICK_S
            simulation.robot.sense(now_s)
            grants.append(simulation.robot.drive(TURN, now_s, now_s))
    assert sum(grant.wheel_speeds == TURN for grant in grants) > 0.95 * len(grants)
    assert not any(grant.latched for grant in grants)


@pytest.mark.deep
@pytest.mark.parametrize("world", ["a", "b", "c"])
async def test_policy_over_a_lossy_cable_follows_walls(world: str) -> None:
    for seed in range(5):
        await policy_drives(lambda: CableLine(LOSSY), seed, 60.0, world)
