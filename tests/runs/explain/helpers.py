"""A simulated robot that is taught in lockstep, some ticks at a time, and what is known of its newest decision."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import anyio

from hal.kurt2_settings import load_kurt2
from hal.robot import WheelSpeeds
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.task_settings import load_task
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.platform.clock import LockstepClock
from kurt2rt.runs.explain.collect import collect_facts
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual, sensor_counterfactuals
from kurt2rt.runs.explain.facts import DecisionFacts, LessonFact, LevelFacts, RlaFacts
from kurt2rt.runs.recording.entries import TickEntry, tick_entry
from kurt2rt.runtime import RuntimeOptions, build_runtime
from simbridge.simulation import Kurt2SimulationFactory

ROBOT = load_kurt2()


class Lesson:
    """A robot in a world, and its teacher."""

    def __init__(
        self,
        task: str = "wall_following",
        seed: int = 1,
        *,
        changes: Mapping[str, str] | None = None,
        clock: type[LockstepClock] = LockstepClock,
        **options: Any,
    ) -> None:
        """Begin; `options`: of the runtime."""
        settings = load_task(task, changes=changes or {})
        self.notebook = InMemoryEventStore()
        self._simulation = Kurt2SimulationFactory(ROBOT).open(settings.teaching.world, seed, "why")
        self.clock: Any = clock(self._simulation.step)
        self.runtime = build_runtime(
            self._simulation.robot, ROBOT, settings, (), self.notebook, self.clock, RuntimeOptions(**options)
        )
        self.records: list[TickRecord] = []

    def close(self) -> None:
        self._simulation.close()

    def go_on(self, ticks: int, *commands: Command) -> TickRecord:
        """Say something, and let some ticks pass; the record of the last one."""
        for command in commands:
            self.runtime.inbox.put(command)
        anyio.run(self.runtime.scheduler.run, ticks, self.records.append)
        return self.records[-1]

    @property
    def facts(self) -> DecisionFacts:
        return collect_facts(
            self.runtime, self.records[-1], lambda command_id: f"2026-11-22T03:10:05+00:00 {command_id}"
        )

    @property
    def counterfactuals(self) -> tuple[SensorCounterfactual, ...]:
        return sensor_counterfactuals(self.facts, self.runtime.definition, ROBOT.infrared)

    @property
    def entries(self) -> list[TickEntry]:
        return [tick_entry(record, saved=False, knowledge=None) for record in self.records]


def story(rla_id: int, condition: tuple[float, ...], action: str, distance: float, radius: float = 10.0) -> RlaFacts:
    taught = LessonFact(f"RLA {rla_id} taught: {action}", "Ann", 1, 100 * rla_id, "2026-11-22T03:10:05+00:00")
    return RlaFacts(rla_id, f"RLA {rla_id}", action, condition, distance, radius, (taught,), 7, 0, 0, None, False)


def level(vector: tuple[float, ...], *stories: RlaFacts, weights: tuple[float, ...] | None = None) -> LevelFacts:
    """Return a level of these RLAs; the first one is the nearest, and drives."""
    nearest = stories[0] if stories else None
    names = tuple(f"f{place}" for place in range(len(vector)))
    counted = weights or (1.0,) * len(vector)
    return LevelFacts(BASIC, "", names, vector, counted, True, nearest, nearest, stories[1:], len(stories))


def facts(basic: LevelFacts, cause: str = "rla", action: str | None = "forward") -> DecisionFacts:
    return DecisionFacts(
        tick=1234,
        now_s=12.34,
        robot="kurt2-indoor",
        task="wall_following",
        phase=2,
        cause=cause,
        action=action,
        asks_at=BASIC,
        decided=WheelSpeeds(0.3, 0.3),
        granted=WheelSpeeds(0.3, 0.3),
        reasons=(),
        latched=False,
        stopped=None,
        trouble="",
        teacher="",
        infrared_counts=(100,) * 18,
        infrared_age_s=0.01,
        basic=basic,
        mid=None,
        overridden=False,
        plan_says="",
    )


def with_mid(of: DecisionFacts, mid: LevelFacts) -> DecisionFacts:
    return replace(of, mid=mid)
