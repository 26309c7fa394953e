"""A fixed route through streets: a closed loop, the same in the lesson and in every exam."""

import math
import random
from collections import Counter
from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from behaviors.metrics.angle_about import MEASURE_EVERY, Mean
from behaviors.metrics.junctions import QUARTERS, require_streets
from behaviors.metrics.routes import Leg, Route, random_route
from behaviors.metrics.streets import Junction, StreetMap
from behaviors.metrics.task_metric import (
    JUNCTIONS,
    LATERAL_DEVIATION,
    RIGHT,
    Metrics,
    MetricSettings,
    TaskMetric,
    WayAhead,
)
from simbridge.contracts.simulation import Pose, Simulation, WorldPlan

_LOOK_EVERY = 5
"""Ticks between two updates; the robot drives some centimeters in them."""
_LEFT_BEHIND_M = 0.1


class RouteSettings(MetricSettings):
    """Settings of the metric `route`: junctions passed in the required way along one closed loop."""

    decisions: Annotated[int, Field(ge=4, le=64)] = 8
    """Junctions of the loop; at each of them one way on is right."""
    seed: Annotated[int, Field(ge=0)] | None = None
    """Seed that chooses among all loops; None: the robot's seed if it is taught the loop."""
    starts: Annotated[int, Field(ge=1, le=100)] = 1
    """Number of starts in the training run: a decision without history is corrected at the next start only."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
        """Raise config.settings.SettingsError without such a loop, or for behaviours that choose no exit."""
        require_streets("route", plan, behaviours)
        self.route_in(plan, behaviours)

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:  # noqa: ARG002
        """Return the metric in a simulation, without random choices: exam and lesson share the route.

        Raises config.settings.SettingsError if the world has no such loop, or for behaviours that choose no exit.
        """
        plan = simulation.plan
        self.require(plan, behaviours)
        return FixedRoute(StreetMap(plan), self.route_in(plan, behaviours), behaviours)

    def route_in(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> Route:
        """Return the loop in a world. Raises config.settings.SettingsError without such a loop."""
        chance = random.Random(f"route of {self.decisions} decisions, seed {self.seed or 0}")
        return random_route(StreetMap(plan), self.decisions, [QUARTERS[each] for each in behaviours], chance)


@dataclass(frozen=True, slots=True)
class Passage:
    """Judgement on the robot at one junction of the route: the turn that was right, and the one it made."""

    leg: int
    """Index of the leg that the robot came by, from 0."""
    right: int
    """Quarter turns to the left that were right."""
    taken: int | None
    """Those that it made; None where it did not come to that junction, or not out of it."""
    x_m: float
    y_m: float
    """Position of the judgement."""


class FixedRoute:
    """Metric of a route: it counts the junctions at which the robot turned as the route does.

    A robot that left the route has a wrong junction and `needs_reset`. It is set down on the street that it should have
    driven into, and judged from there. If it is stuck on its way to a junction, it tries that junction again. If it is
    stuck within a junction, it goes on after it.
    """

    unit = "junctions"

    def __init__(self, streets: StreetMap, route: Route, behaviours: tuple[str, ...]) -> None:
        self.route = route
        self.needs_reset = False
        self.passages: list[Passage] = []
        """Passages through junctions so far."""
        self._streets = streets
        self._behaviours = behaviours
        self._meaning = {QUARTERS[each]: each for each in behaviours}
        self._leg = 0
        """Leg of the street or junction that the robot is in."""
        self._passed = 0
        self._inside = False
        self._pose = self._at(0).middle
        self._deviation2_m2 = Mean()
        self._looks = 0
        self._ticks = 0

    @property
    def behaviour(self) -> str:
        """Required behaviour at the current or next junction."""
        return self._meaning[self._at(0).quarters]

    @property
    def ahead(self) -> WayAhead:
        """Position on the route, with the required behaviour and the turn there."""
        return WayAhead(self._passed, self._inside, self.behaviour, self._meaning[self._at(1).quarters])

    @property
    def reset_pose(self) -> Pose:
        """Pose in the middle of the street that the robot should be in, looking ahead."""
        return self._at(1 if self._inside else 0).middle

    @property
    def progress(self) -> float:
        """Count of junctions passed in the required way."""
        return float(sum(each.taken == each.right for each in self.passages))

    @property
    def findings(self) -> Metrics:
        """Junctions and right ones, in total and by behaviour, and the lateral deviation in m."""
        asked = Counter(each.right for each in self.passages)
        right = Counter(each.right for each in self.passages if each.taken == each.right)
        found = {JUNCTIONS: float(asked.total()), RIGHT: float(right.total())}
        for each in self._behaviours:
            found[f"{JUNCTIONS}, {each}"] = float(asked[QUARTERS[each]])
            found[f"{RIGHT}, {each}"] = float(right[QUARTERS[each]])
        deviation_m = {name: math.sqrt(mean) for name, mean in self._deviation2_m2.as_metric(LATERAL_DEVIATION).items()}
        return found | deviation_m

    def reset(self, pose: Pose) -> None:
        """Continue at this pose: after the junction under way, which counts as wrong, or toward the next one."""
        self.needs_reset = False
        if self._inside:
            self._judge(None)
            self._go_on()
        self._pose = pose

    def update(self, pose: Pose) -> None:
        """Update the metric with the robot's pose."""
        due = self._ticks % _LOOK_EVERY == 0
        self._ticks += 1
        if not due or self.needs_reset:
            return
        self._pose = pose
        if self._looks % (MEASURE_EVERY // _LOOK_EVERY) == 0:
            deviation_m = self._streets.deviation_m(pose)
            if deviation_m is not None:
                self._deviation2_m2.add(deviation_m * deviation_m)
        self._looks += 1
        junction = self._at(0).junction
        if self._inside:
            if not junction.holds(pose, _LEFT_BEHIND_M):
                self._leave(junction, pose)
        elif junction.holds(pose):
            self._inside = True
        elif self._streets.junction_at(pose) is not None:  # it turned back on the way
            self._judge(None)
            self.needs_reset = True

    def abort(self) -> None:
        """Count the junction ahead as wrong: the robot will not get through."""
        self._judge(None)

    def _leave(self, junction: Junction, pose: Pose) -> None:
        leg = self._at(0)
        taken = (junction.side_of(pose) - leg.way + 1) % 4 - 1
        self._judge(taken)
        self.needs_reset = taken != leg.quarters
        self._go_on()

    def _go_on(self) -> None:
        self._leg = (self._leg + 1) % len(self.route.legs)
        self._passed += 1
        self._inside = False

    def _judge(self, taken: int | None) -> None:
        self.passages.append(Passage(self._leg, self._at(0).quarters, taken, self._pose.x_m, self._pose.y_m))

    def _at(self, further: int) -> Leg:
        return self.route.legs[(self._leg + further) % len(self.route.legs)]
