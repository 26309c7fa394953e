"""Basic level: RLAs over the 72-D situation, of the active behaviour; their actions are the repertoire's."""

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from behaviors.repertoire import Repertoire
from hal.robot import STANDSTILL, SensorReadings
from kurt2rt.core.basic.doubt import DoubtMeter, DoubtWatch, NewObstacle
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.basic.held_action import HeldAction
from kurt2rt.core.decision.decision import (
    ActiveBehaviour,
    Decision,
    DecisionCause,
    UnknownActionError,
    UnknownBehaviourError,
)
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.events import (
    ActionReplaced,
    ActionWithdrawn,
    LessonRedone,
    LessonUndone,
    RlaCreated,
    RlaDeleted,
    TeachingEvent,
)
from kurt2rt.core.rla.matching import exact_square
from kurt2rt.core.rla.rla import BASIC, Rla
from kurt2rt.core.rla.rla_system import RlaSystem

_RLA, _HELD = DecisionCause.RLA, DecisionCause.HELD
"""Names for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""


def _named(behaviour: str) -> str:
    return f"the behaviour {behaviour}" if behaviour else "a behaviour without a name, the only one of its task"


def _require_known(rlas: Iterable[Rla], repertoire: Repertoire, behaviours: Sequence[str]) -> None:
    """Require RLAs whose behaviour and action are known. Raises UnknownBehaviourError, UnknownActionError."""
    for rla in rlas:
        if rla.behaviour not in behaviours:
            raise UnknownBehaviourError(
                f"RLA {rla.rla_id} belongs to {_named(rla.behaviour)}, and this task teaches "
                f"{', '.join(behaviours) or 'one without a name'}; "
                "give the task that this knowledge was taught with"
            )
        if rla.action not in repertoire and not rla.is_withdrawn:
            raise UnknownActionError(
                f"RLA {rla.rla_id} has the action {rla.action}, which the repertoire lacks; "
                f"add it there, or teach with the repertoire it came from: {', '.join(repertoire)}"
            )


class BasicLevel:
    """Level that drives by sensors (paper, section III.A): the action of the nearest RLA inside R, else a question.

    An action drives for a minimum time, so that the robot does not alternate between neighbouring RLAs. Only RLAs of
    the active behaviour compete. `Tick` calls `decide` once per tick, directly or through `LayerStack`.
    """

    def __init__(
        self,
        system: RlaSystem,
        repertoire: Repertoire,
        minimum_action_ticks: int,
        active_behaviour: ActiveBehaviour,
        choice: EpsilonGreedy | None = None,
        doubt: DoubtMeter | None = None,
    ) -> None:
        """Check the RLAs and connect them to the repertoire.

        Args:
            system: with the taught RLAs.
            repertoire: actions that the RLAs name.
            minimum_action_ticks: ticks before another RLA's action may replace the driving one.
            active_behaviour: only its RLAs compete.
            choice: chooses among RLAs on the same condition; without it the oldest answers.
            doubt: score by which the robot stands and asks inside the radius; None: it never doubts.

        Raises:
            UnknownActionError: for an RLA whose action the repertoire lacks.
            UnknownBehaviourError: for an RLA of a behaviour that the task lacks.
        """
        _require_known(system.rlas, repertoire, active_behaviour.behaviours)
        self.system = system
        self.repertoire = repertoire
        self.active_behaviour = active_behaviour
        self._behaviour = active_behaviour.behaviour
        self._held = HeldAction(repertoire, minimum_action_ticks)
        self._choice = choice
        self.doubt = doubt
        self._doubts = None if doubt is None else DoubtWatch(doubt)
        self._memory = None if doubt is None else doubt.memory
        self.skip_withdrawn = False
        """Skip RLAs whose action was withdrawn, so that their neighbours answer."""
        self.counts = True
        """Whether this tick counts for the minimum time of an action; a slow lesson leaves out some."""
        self.held_action = ""
        """Action whose minimum time was not over at the last decision; empty if any action could drive."""
        self._decisions = 0
        self._driver: Rla | None = None
        self._drivers_condition: NDArray[np.float64] | None = None
        """Condition of the RLA that drives, shape (d,), once it was needed."""

    def restart(self) -> None:
        """Stop the driving action, forget obstacles and the choices among RLAs of one condition; the RLAs stay."""
        self._held.stop()
        self._driver = None
        self.forget_obstacles()
        if self._choice is not None:
            self._choice.reset()

    def forget_obstacles(self) -> None:
        """Forget the remembered obstacles, because the robot was set down elsewhere."""
        if self._memory is not None:
            self._memory.clear()

    def apply(self, event: TeachingEvent) -> None:
        """Change the knowledge; the next decision follows it at once, even if an action is held.

        Raises InvalidEventError, with nothing changed, if the event does not fit the knowledge.
        """
        drives = self._is_about_driving(event)
        self.system.apply(event)
        if drives:
            self._held.allow_switch()
            if self.doubt is not None:
                self.doubt.on_lesson()

    def _is_about_driving(self, event: TeachingEvent) -> bool:
        """Return whether an event, not yet applied, may change the driving RLA; rewards and critic lessons do not."""
        match event:
            case RlaCreated(rla):
                return rla.level == BASIC
            case ActionReplaced(rla_id) | ActionWithdrawn(rla_id) | RlaDeleted(rla_id):
                rla_meant = self.system.get(rla_id)
                return rla_meant is not None and rla_meant.level == BASIC
        return isinstance(event, LessonUndone | LessonRedone)

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:
        """Return the decision of this tick: drive by the nearest RLA's action or the held one, or stand.

        It stands for `blocking_cause`, and outside R of every RLA. `situation`: vector (d,).
        """
        if self._behaviour != self.active_behaviour.behaviour:
            self._behaviour = self.active_behaviour.behaviour
            self._held.allow_switch()
        self._decisions += 1
        if self._memory is not None:
            self._memory.update(readings)
        self.held_action = self._held.held
        match = self.system.match(situation.vector, self._behaviour, include_withdrawn=not self.skip_withdrawn)
        if blocking_cause is not None:
            return self._stand(blocking_cause, match)
        if match is None or not match.known:
            return self._stand(DecisionCause.UNKNOWN, match)
        rla = match.rla
        if self._choice is not None:
            group = self.system.competitors(rla)
            if len(group) > 1:
                rla = self._choice.choose(group, self._decisions)
        if self._held.select(rla.action):
            if rla is not self._driver:
                self._driver, self._drivers_condition = rla, None
            return self._drive(situation, readings, _RLA, rla, match, answers=True)
        driver = self._driver
        assert driver is not None  # an RLA's action is held
        answers = driver.condition == rla.condition or self._inside(driver, situation)
        return self._drive(situation, readings, _HELD, driver, match, answers=answers)

    def would_answer(self, group: tuple[Rla, ...]) -> Rla:
        """Return the RLA of a group that would answer in the next decision without random exploration.

        `group`: RLAs with an equal condition, oldest first, at least one.
        """
        return group[0] if self._choice is None else self._choice.preview(group, self._decisions)

    def _drive(
        self,
        situation: Situation,
        readings: SensorReadings,
        cause: DecisionCause,
        rla: Rla,
        match: Match,
        *,
        answers: bool,
    ) -> Decision:
        """Step the held action; ask if it is lost, or in doubt."""
        wheel_speeds = self._held.step(readings, counts=self.counts)
        if self._held.lost:
            # The action is not restarted: it goes on by itself once its situation is known again.
            return Decision(STANDSTILL, DecisionCause.UNKNOWN, None, None, match)
        action, doubts, score = self._held.name, self._doubts, None
        if doubts is not None:
            score = doubts.meter.score(situation.vector, match, action, self._behaviour)
            if doubts.update(score, alone=self.skip_withdrawn):
                self._held.stop()
                return Decision(STANDSTILL, DecisionCause.DOUBT, None, None, match, doubt=score)
        return Decision(wheel_speeds, cause, action, rla.rla_id, match, answers, doubt=score, image=rla.image)

    def new_obstacle(self, match: Match, vector: NDArray[np.float64]) -> NewObstacle | None:
        """Return the sensor that makes the robot doubt the nearest RLA in a situation (d,); None if no sensor does."""
        return None if self.doubt is None else self.doubt.obstacle(vector, match, match.rla.action, match.rla.behaviour)

    def _inside(self, rla: Rla, situation: Situation) -> bool:
        """Return whether the situation lies within the radius of the driving RLA, although another RLA is nearer."""
        if self._drivers_condition is None:
            self._drivers_condition = np.array(rla.condition)
        off = (situation.vector - self._drivers_condition) * self.system.weights
        radius = self.system.whole_radius(rla)
        return exact_square(off) <= radius * radius

    def _stand(self, cause: DecisionCause, match: Match | None) -> Decision:
        """Stop the held action; the next one starts from its beginning."""
        self._held.stop()
        if self._doubts is not None:
            self._doubts.end()
        return Decision(STANDSTILL, cause, None, None, match)
