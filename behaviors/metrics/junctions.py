"""Junctions on a way through streets: a dispatcher says which way to take, and sees which way was taken."""

import math
import random
from collections import Counter
from collections.abc import Sequence

from behaviors.metrics.angle_about import MEASURE_EVERY, Mean
from behaviors.metrics.streets import Junction, Side, StreetMap, side_towards
from behaviors.metrics.task_metric import JUNCTIONS, LATERAL_DEVIATION, RIGHT, Metrics, MetricSettings, TaskMetric
from config.settings import SettingsError
from hal.numerics import cos_sin
from simbridge.contracts.areas import Borders
from simbridge.contracts.simulation import Pose, Simulation, WorldPlan

QUARTERS = {"straight_on": 0, "turn_left": 1, "turn_right": -1}
"""Quarter turns to the left of each behaviour."""
_LOOK_EVERY = 5
"""Ticks between two updates; the robot drives some centimeters in them."""
_MEASURE_LOOKS = MEASURE_EVERY // _LOOK_EVERY
_LEFT_BEHIND_M = 0.1


def require_streets(metric: str, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
    """Raise config.settings.SettingsError without junctions, or for behaviours that choose no exit."""
    if not set(behaviours) <= set(QUARTERS):
        raise SettingsError(f"metric {metric}: the task's behaviours must be among {', '.join(QUARTERS)}")
    if not plan.junctions:
        raise SettingsError(
            f"metric {metric}: world {plan.name} has no streets that meet", do="choose one with streets"
        )


class JunctionsSettings(MetricSettings):
    """Settings of the metric `junctions`: junctions left through the required side."""

    def require(self, plan: WorldPlan, behaviours: tuple[str, ...]) -> None:
        """Raise config.settings.SettingsError without junctions, or for behaviours that choose no exit."""
        require_streets("junctions", plan, behaviours)

    def build(self, simulation: Simulation, behaviours: tuple[str, ...], chance: random.Random) -> TaskMetric:
        """Return the metric in a simulation, which draws the required behaviours by `chance`.

        Raises config.settings.SettingsError if the world has no junctions, or for behaviours that choose no exit.
        """
        plan = simulation.plan
        self.require(plan, behaviours)
        return Junctions(StreetMap(plan), behaviours, chance)


class Junctions:
    """Metric of junctions: it asks at random for what is possible at the next one, and counts what is done.

    The next command comes as soon as the robot has left a junction. A junction counts as wrong if the robot did not get
    to it, or not out of it. So do a turn back and an early end. If none of its behaviours is possible at the junction
    ahead, `needs_reset` is set.
    """

    unit = "junctions"

    def __init__(self, streets: StreetMap, behaviours: tuple[str, ...], chance: random.Random) -> None:
        self.behaviour = behaviours[0]
        self.needs_reset = False
        self._streets = streets
        self._behaviours = behaviours
        self._chance = chance
        self._inside: Junction | None = None
        self._asked: Side | None = None
        """The side of that junction that the command means; None when nothing is asked for there."""
        self._ahead: Junction | None = None
        """The junction that the command is about while the robot is on the way there; None when about none."""
        self._passed: Counter[str] = Counter()
        self._right: Counter[str] = Counter()
        self._deviation2_m2 = Mean()
        self._looks = 0
        self._ticks = 0

    @property
    def borders(self) -> Borders:
        """Borders of all junctions, at which a robot enters or leaves one."""
        return Borders(_LOOK_EVERY, _LEFT_BEHIND_M, tuple(each.area for each in self._streets.junctions))

    @property
    def progress(self) -> float:
        """Count of junctions left through the required side."""
        return float(self._right.total())

    @property
    def findings(self) -> Metrics:
        """Junctions required and right, in total and by behaviour, and the lateral deviation in m."""
        found = {JUNCTIONS: float(self._passed.total()), RIGHT: float(self._right.total())}
        if len(self._behaviours) > 1:
            for each in self._behaviours:
                found[f"{JUNCTIONS}, {each}"] = float(self._passed[each])
                found[f"{RIGHT}, {each}"] = float(self._right[each])
        deviation_m = {name: math.sqrt(mean) for name, mean in self._deviation2_m2.as_metric(LATERAL_DEVIATION).items()}
        return found | deviation_m

    def reset(self, pose: Pose) -> None:
        """Start here: the next junction is ahead of the robot."""
        self.needs_reset = False
        way = side_towards(*cos_sin(pose.heading_rad))
        self._asked = self._ahead = None
        self._inside = self._streets.junction_at(pose)
        if self._inside is None:
            self._ahead = self._command(self._streets.next_junction(pose, way), way)
        else:
            self._command(self._inside, way)  # not judged: the direction of its arrival is unknown

    def update(self, pose: Pose) -> None:
        """Count a junction that this pose has left, and the deviation in the street; call it in every tick."""
        self.update_all([pose])

    def update_all(self, poses: Sequence[Pose]) -> None:
        """Update the metric with the robot's poses of ticks in a row."""
        looks = poses[-self._ticks % _LOOK_EVERY :: _LOOK_EVERY]
        self._ticks += len(poses)
        if not looks:
            return
        for deviation_m in self._streets.deviations_m(looks[-self._looks % _MEASURE_LOOKS :: _MEASURE_LOOKS]):
            self._deviation2_m2.add(deviation_m * deviation_m)
        self._looks += len(looks)
        for pose, junction in zip(looks, self._streets.junctions_at(looks), strict=True):
            self._look(pose, junction)

    def _look(self, pose: Pose, junction: Junction | None) -> None:
        """Enter or leave a junction; `junction`: that holds the pose."""
        if self._inside is None:
            if junction is not None:
                self._enter(junction, junction.side_of(pose).turned(2))
        elif not self._inside.holds(pose, _LEFT_BEHIND_M):
            self._leave(self._inside, pose)

    def abort(self) -> None:
        """Count the current junction as wrong: the robot will not get through."""
        if self._asked is not None or self._ahead is not None:
            self._judge(right=False)
        self._asked = self._ahead = None

    def _enter(self, junction: Junction, way: Side) -> None:
        if self._ahead is not None and self._ahead != junction:
            self._judge(right=False)  # it turned back on the way
        self._ahead = None
        self._inside = junction
        if self._side_meant(junction, way, self.behaviour) is None:
            # It came to another junction than the command is about, or its only behaviour leads nowhere here.
            self._command(junction, way)
        self._asked = self._side_meant(junction, way, self.behaviour)
        self.needs_reset = self._asked is None

    def _leave(self, junction: Junction, pose: Pose) -> None:
        way = junction.side_of(pose)
        if self._asked is not None:
            self._judge(right=way is self._asked)
        self._inside = self._asked = None
        self._ahead = self._command(self._streets.next_junction(pose, way), way)

    def _judge(self, *, right: bool) -> None:
        self._passed[self.behaviour] += 1
        self._right[self.behaviour] += right

    def _command(self, junction: Junction | None, way: Side) -> Junction | None:
        """Ask for something that is possible at this junction for a robot that comes this way.

        Returns the junction, or None where nothing can be asked for.
        """
        if junction is None:
            return None
        possible = [each for each in self._behaviours if self._side_meant(junction, way, each) is not None]
        if not possible:
            return None
        self.behaviour = self._chance.choice(possible)
        return junction

    @staticmethod
    def _side_meant(junction: Junction, way: Side, behaviour: str) -> Side | None:
        side = way.turned(QUARTERS[behaviour])
        return side if side in junction.arms else None
