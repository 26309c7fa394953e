"""Policy of other knowledge on the situations of a replayed run."""

import math
from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from config.settings import SettingsError
from kurt2rt.core.basic.epsilon_greedy import EpsilonGreedy
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.mid.settings import load_mid_level
from kurt2rt.core.outcome_text import event_error_text
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.reinforcement.decision_history import DecisionHistory
from kurt2rt.core.reinforcement.reinforcement import Reinforcement
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.events import InvalidEventError, TeachingEvent
from kurt2rt.core.rla.rla import BASIC, MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import read_knowledge
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run
from kurt2rt.runtime import Runtime, empty_system


class PolicyAnswer(NamedTuple):
    """Answer of a level's RLAs to a situation, before minimum times and the guard."""

    rla: Rla | None
    """RLA that answers; None if none is near enough."""
    nearest: Rla | None
    """Nearest RLA; None without knowledge."""
    distance: float
    """Distance to the nearest RLA; infinite without one."""
    radius: float
    """Radius of the nearest RLA; 0 without one."""

    @property
    def action(self) -> str | None:
        """Action of the answer; None for a question."""
        return None if self.rla is None else self.rla.action


class PolicyAnswers(NamedTuple):
    """Answers of basic and mid level to the situation of one tick, to be compared with other knowledge's."""

    basic: PolicyAnswer
    mid: PolicyAnswer | None
    """None if the task has no mid level."""


class CounterfactualPolicy:
    """Other knowledge that answers the situations of a replayed run, without acting or learning."""

    def __init__(self, run: Run, events: Iterable[TeachingEvent], statistics: Statistics | None = None) -> None:
        """Build the policy with the run's own settings.

        `events`: lessons. `statistics`: values of RLAs that share a condition. Raises RecordingError for knowledge that
        does not fit the settings.
        """
        try:
            with run.settings():
                task = run.task
                definition = load_situation(task.situation, run.robot.infrared.names)
                mid = None if task.mid is None else load_mid_level(task.mid)
                self._system = empty_system(run.robot, task, definition, load_critic(task.critic), mid)
            recent = DecisionHistory(definition.dimensions)
            self._worths = Reinforcement(self._system, recent, task.reinforcement, run.robot.cycle_s)
            self._worths.restore(tuple(events), statistics)
        except (SettingsError, InvalidEventError) as error:
            cause = event_error_text(error) if isinstance(error, InvalidEventError) else str(error)
            raise RecordingError(f"this knowledge cannot decide there: {cause}", where=run.name) from error

    def answer(self, situation: NDArray[np.float64], behaviour: str, level: str = BASIC) -> PolicyAnswer:
        """Return the answer of a level to a situation vector, shape (d,), for the active behaviour."""
        match = self._system.match(situation, behaviour, level)
        return _answer(match, self._system, self._worths.choice) if level == BASIC else _mid_answer(match)

    def answers(self, record: TickRecord, runtime: Runtime) -> PolicyAnswers:
        """Return the answers to a tick that was just replayed in `runtime`.

        The basic level answers for the behaviour of that tick. Withdrawn RLAs are left out if no teacher could be
        asked.
        """
        system, choice = self._system, self._worths.choice
        asking = not runtime.level.skip_withdrawn
        basic = system.match(record.situation.vector, record.behaviour, include_withdrawn=asking)
        mid = None
        if runtime.mid is not None:
            mid = _mid_answer(system.match(runtime.mid.vector, level=MID))
        return PolicyAnswers(_answer(basic, system, choice), mid)


def load_policy(run: Run, knowledge: Path) -> CounterfactualPolicy:
    """Return the policy of a knowledge file, which may be in use by a robot.

    Raises RecordingError if the run's settings cannot be read, KnowledgeError if the file does not fit them.
    """
    with run.settings():
        events, statistics = read_knowledge(knowledge, run.robot, run.task)
    return CounterfactualPolicy(run, events, statistics)


def recorded_answers(record: TickRecord, runtime: Runtime) -> PolicyAnswers:
    """Return the answers of the run's own knowledge in a tick that was just replayed in `runtime`.

    They come from the decision: the robot may have learnt since, even in that tick. If the mid level asked, the basic
    level did not decide and has no answer.
    """
    decision = record.decision
    mid = None if decision.mid is None else _mid_answer(decision.mid.match)
    match = decision.match if decision.asks_at == BASIC else None
    answer = _answer(match, runtime.level.system, runtime.reinforcement.choice)
    if match is not None and decision.cause is DecisionCause.RLA and decision.action is not None:
        drove = match.rla
        if drove.rla_id != decision.rla_id:  # of those on the very same condition another one was chosen
            drove = (None if decision.rla_id is None else runtime.level.system.get(decision.rla_id)) or drove
        answer = answer._replace(rla=replace(drove, action=decision.action))
    return PolicyAnswers(answer, mid)


def _answer(match: Match | None, system: RlaSystem, choice: EpsilonGreedy) -> PolicyAnswer:
    """Return the basic level's answer: the best RLA among those on one condition."""
    if match is None or not match.known:
        return _mid_answer(match)
    group = system.competitors(match.rla)
    # An RLA that was deleted or changed since has no competitors.
    rla = choice.best(group) if len(group) > 1 and match.rla in group else match.rla
    return PolicyAnswer(rla, match.rla, match.distance, match.radius)


def _mid_answer(match: Match | None) -> PolicyAnswer:
    """Return the mid level's answer: on one condition the oldest RLA, unless a plan chooses."""
    if match is None:
        return PolicyAnswer(None, None, math.inf, 0.0)
    return PolicyAnswer(match.rla if match.known else None, match.rla, match.distance, match.radius)
