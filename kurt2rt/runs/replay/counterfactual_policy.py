"""Another knowledge that looks on at a replayed run: what it would have decided in the very same situations."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from hal.settings import SettingsError
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import Cause
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import BASIC, MID, Rla, TeachingEvent
from kurt2rt.core.rla.rla_system import InvalidEventError, RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.tick import TickRecord
from kurt2rt.knowledge.journal.loading import read_knowledge
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run
from kurt2rt.runtime import Runtime, empty_system


class PolicyAnswer(NamedTuple):
    """What knowledge says to a situation, before it is held to a minimum time and before any guard."""

    rla: Rla | None
    """The RLA that answers; None where none is near enough."""
    nearest: Rla | None
    """The nearest; None where nothing was taught."""
    distance: float
    """To the nearest; infinite where there is none."""
    radius: float
    """Of the nearest; 0 where there is none."""

    @property
    def action(self) -> str | None:
        """What would be done; None: it asks."""
        return None if self.rla is None else self.rla.action

    @property
    def share_of_radius(self) -> float:
        """How far off the nearest condition is, as a share of R."""
        return self.distance / self.radius if self.radius else math.inf


class PolicyAnswers(NamedTuple):
    """What knowledge says in one tick."""

    basic: PolicyAnswer
    mid: PolicyAnswer | None
    """None where the task has no mid level."""


class CounterfactualPolicy:
    """Knowledge that decides on the situations of a run, and does nothing. Nothing is learnt meanwhile."""

    def __init__(self, run: Run, events: Iterable[TeachingEvent], statistics: Statistics | None = None) -> None:
        """`events`: what was taught; `statistics`: what the RLAs are worth, where several stand on one condition.

        It matches as the run's own settings say. Raises RecordingError for knowledge that does not fit them.
        """
        try:
            with run.settings():
                task = run.task
                definition = load_situation(task.situation, run.robot.infrared.names)
                mid = None if task.mid is None else load_mid_level(task.mid)
                self._system = empty_system(task, definition, load_critic(task.critic), mid)
            recent = DecisionHistory(definition.dimensions)
            self._worths = Reinforcement(self._system, recent, task.reinforcement, run.robot.can.cycle_s)
            self._worths.restore(tuple(events), statistics)
        except (SettingsError, InvalidEventError) as error:
            raise RecordingError(f"this knowledge cannot decide there: {error}", where=run.name) from error

    def answer(self, situation: NDArray[np.float64], behaviour: str, level: str = BASIC) -> PolicyAnswer:
        """What it says to a situation vector (d,) of a level, where that behaviour is wanted."""
        match = self._system.match(situation, behaviour, level)
        return _answer(match, self._system, self._worths.choice) if level == BASIC else _mid_answer(match)

    def answers(self, record: TickRecord, runtime: Runtime) -> PolicyAnswers:
        """What it says to the situations of a tick that was just replayed in `runtime`.

        The basic level answers for the behaviour that was wanted then, and passes over RLAs whose action was withdrawn
        where the robot did: nobody was there to be asked.
        """
        system, choice = self._system, self._worths.choice
        asking = not runtime.level.skip_withdrawn
        basic = system.match(record.situation.vector, record.behaviour, asking=asking)
        mid = None
        if runtime.mid is not None:
            mid = _mid_answer(system.match(runtime.mid.vector, level=MID))
        return PolicyAnswers(_answer(basic, system, choice), mid)


def load_policy(run: Run, knowledge: Path) -> CounterfactualPolicy:
    """The knowledge in a file, which may be that of a robot that runs. Raises RecordingError, KnowledgeError."""
    with run.settings():
        events, statistics = read_knowledge(knowledge, run.robot, run.task)
    return CounterfactualPolicy(run, events, statistics)


def recorded_answers(record: TickRecord, runtime: Runtime) -> PolicyAnswers:
    """What the run's own knowledge said in a tick that was just replayed in `runtime`.

    It is what was decided: by now the robot may have been taught otherwise, by itself in that very tick. Where the mid
    level asked, the basic level was not heard, and is not here.
    """
    decision = record.decision
    mid = None if decision.mid is None else _mid_answer(decision.mid.match)
    match = decision.match if decision.asks_at == BASIC else None
    answer = _answer(match, runtime.level.system, runtime.reinforcement.choice)
    if match is not None and decision.cause is Cause.RLA and decision.action is not None:
        drove = match.rla
        if drove.rla_id != decision.rla_id:  # of those on the very same condition another one was chosen
            drove = (None if decision.rla_id is None else runtime.level.system.get(decision.rla_id)) or drove
        answer = answer._replace(rla=replace(drove, action=decision.action))
    return PolicyAnswers(answer, mid)


def _answer(match: Match | None, system: RlaSystem, choice: EpsilonGreedy) -> PolicyAnswer:
    """Of the basic level: of competitors the one of most worth drives."""
    if match is None or not match.known:
        return _mid_answer(match)
    group = system.competitors(match.rla)
    # One that was deleted since, or told something else, has nobody to be compared with.
    rla = choice.best(group) if len(group) > 1 and match.rla in group else match.rla
    return PolicyAnswer(rla, match.rla, match.distance, match.radius)


def _mid_answer(match: Match | None) -> PolicyAnswer:
    """Of ways from one place a plan chooses, or the oldest leads."""
    if match is None:
        return PolicyAnswer(None, None, math.inf, 0.0)
    return PolicyAnswer(match.rla if match.known else None, match.rla, match.distance, match.radius)
