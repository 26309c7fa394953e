"""Collection of a decision's facts from a runtime and the record of its newest tick."""

import math
from collections.abc import Callable
from dataclasses import replace
from itertools import islice, takewhile
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import Decision, DecisionCause, MidDecision
from kurt2rt.core.layer_stack import GOAL_CAUSES
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.events import RlaRewarded
from kurt2rt.core.rla.lesson_history import LessonRecord
from kurt2rt.core.rla.rla import BASIC, MID, Rla
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.explain.facts import (
    MOST_OTHERS,
    ContactFacts,
    DecisionFacts,
    DoubtFacts,
    LessonFact,
    LevelFacts,
    RlaFacts,
)
from kurt2rt.runtime import Runtime

_PASSED_OVER = 12
"""Extra candidates read per level: withdrawn RLAs are left out if no teacher can be asked."""

StampOf = Callable[[str], str]
"""Function from a command id to the UTC time (ISO 8601) at which its lesson was written; empty if unknown."""


def collect_facts(
    runtime: Runtime,
    record: TickRecord,
    stamp_of: StampOf,
    *,
    most: int | None = None,
) -> DecisionFacts:
    """Return the facts behind the decision of `record`, the newest tick of `runtime`.

    `most`: number of RLAs reported per level in addition to the nearest; None: all. A small number takes about 1 ms for
    any number of RLAs.
    """
    decision, school = record.decision, runtime.handler
    reader = _Reader(runtime, stamp_of, most)
    mid = decision.mid
    return DecisionFacts(
        tick=record.tick,
        now_s=record.now_s,
        robot=runtime.robot.name,
        task=runtime.task.name,
        phase=int(school.phase),
        cause=decision.cause.value,
        action=decision.action,
        asks_at=decision.asks_at,
        decided=decision.wheel_speeds,
        granted=record.guard_result.wheel_speeds,
        reasons=record.guard_result.reasons,
        latched=record.guard_result.latched,
        stopped=school.stops.active,
        trouble=record.saving_error or school.learner_failure or "",
        teacher=school.authority.teacher or "",
        infrared_counts=record.trusted_counts or record.readings.infrared_counts,
        infrared_age_s=record.readings.infrared_age_s,
        basic=reader.basic(record, decision),
        mid=None if mid is None else reader.mid(mid),
        overridden=mid is not None and mid.overridden,
        plan_says="" if decision.plan is None else decision.plan.says,
        kept=runtime.level.held_action,
        history_frozen=record.situation.history_frozen,
        taught_now=bool(record.events),
        broken_sensors=tuple(sensor.title for sensor in record.broken_sensors),
        hindrances=_blocking_causes(runtime, record),
        doubt=_doubt(runtime, decision, record.situation.vector),
        lesson_speed=record.lesson_speed,
    )


class LiveExplainer:
    """Newest tick of a running robot, whose facts are collected at most once per tick."""

    def __init__(self, runtime: Runtime, stamp_of: StampOf) -> None:
        """`stamp_of`: time at which the lesson of a command became durable."""
        self._runtime = runtime
        self._stamp_of = stamp_of
        self._newest: TickRecord | None = None
        self._facts: DecisionFacts | None = None

    def follow(self, record: TickRecord) -> None:
        """Keep the record of a tick. Takes constant time."""
        self._newest, self._facts = record, None

    def facts(self) -> DecisionFacts | None:
        """Return the facts of the newest decision; None before the first tick. Call it between ticks."""
        if self._facts is None and self._newest is not None:
            self._facts = collect_facts(self._runtime, self._newest, self._stamp_of, most=MOST_OTHERS)
        return self._facts


def _doubt(runtime: Runtime, decision: Decision, vector: NDArray[np.float64]) -> DoubtFacts | None:
    """Return the doubt of a decision in a situation (d,); None without one."""
    meter, score, match = runtime.level.doubt, decision.doubt, decision.match
    if meter is None or score is None or match is None:
        return None
    contact = _contact(runtime, _doubted_action(runtime, decision, match))
    new = runtime.level.new_obstacle(match, vector)
    if new is None:
        return DoubtFacts(score, meter.settings.threshold, contact=contact)
    words, name = words_for(runtime.robot.infrared), runtime.definition.names[new.feature]
    reads, taught = words.reading(name, new.here), words.reading(name, new.taught)
    return DoubtFacts(score, meter.settings.threshold, words.place(name), reads, taught, contact)


def _doubted_action(runtime: Runtime, decision: Decision, match: Match) -> str:
    """Return the action that drives, or that would drive if the robot did not doubt it."""
    if decision.action is None:
        return runtime.level.held_action or match.rla.action
    return decision.action


def _contact(runtime: Runtime, action: str) -> ContactFacts | None:
    """Return the remembered obstacle that an action would meet; None without one."""
    meter = runtime.level.doubt
    found = None if meter is None or meter.memory is None else meter.memory.contact(action)
    if found is None:
        return None
    sensor = runtime.robot.infrared.sensors[found.sensor]
    return ContactFacts(action, found.within_s, f"{sensor.label} ({sensor.name})", found.seen_s)


def _blocking_causes(runtime: Runtime, record: TickRecord) -> tuple[str, ...]:
    """Return the causes that would stop the robot, highest priority first."""
    school, navigator, mid = runtime.handler, runtime.navigator, record.decision.mid
    blind = not record.readings.infrared_age_s <= runtime.robot.guard.stale_infrared_s
    causes = school.causes_to_stand(record.tick, blind=blind, unsaved=record.saving_error is not None)
    found = [cause.value for cause in causes if cause is not DecisionCause.STOPPED]
    if navigator is not None and mid is not None and not mid.overridden:
        by_goal = GOAL_CAUSES.get(navigator.standing_status)
        found += [] if by_goal is None else [by_goal.value]
    return tuple(found)


class _LevelSituation(NamedTuple):
    names: tuple[str, ...]
    vector: NDArray[np.float64]
    """Shape (d,)."""
    weights: NDArray[np.float64]
    """Shape (d,)."""
    euclidean: bool = True


class _Reader:
    """Lookup of levels and RLAs in one runtime."""

    def __init__(self, runtime: Runtime, stamp_of: StampOf, most: int | None) -> None:
        self._runtime = runtime
        self._system: RlaSystem = runtime.level.system
        self._stamp_of = stamp_of
        self._most = most

    def basic(self, record: TickRecord, decision: Decision) -> LevelFacts:
        vector, system = record.situation.vector, self._system
        # Where the mid level asks, the decision holds that level's match.
        asking = not self._runtime.level.skip_withdrawn
        match = decision.match
        if decision.asks_at != BASIC:
            match = system.match(vector, record.behaviour, include_withdrawn=asking)
        situation = _LevelSituation(self._runtime.definition.names, vector, system.weights)
        driver = self._system.get(decision.rla_id or 0)
        if driver is not None and decision.image:
            driver = system.images[decision.image].rla(driver)
        return self._level(BASIC, record.behaviour, situation, match, driver)

    def mid(self, decision: MidDecision) -> LevelFacts | None:
        mid = self._runtime.mid
        if mid is None:
            return None
        space, vector = mid.settings.space, mid.vector
        weights = np.ones(space.dimensions) if space.weights is None else space.weights
        situation = _LevelSituation(mid.settings.features, vector, weights, euclidean=space.metric == "euclidean")
        facts = self._level(MID, "", situation, decision.match, self._system.get(decision.rla_id or 0))
        words = mid.settings.situation.describe
        there = () if facts.nearest is None else words(facts.nearest.condition)
        return replace(facts, words=words(vector), nearest_words=there)

    def _level(
        self,
        level_name: str,
        behaviour: str,
        situation: _LevelSituation,
        match: Match | None,
        driver: Rla | None,
    ) -> LevelFacts:
        ranking = self._ranking(level_name, behaviour, situation.vector, driver)
        distances = {rla.key: distance for rla, distance in ranking}
        matched = None if match is None else match.rla.key
        nearer = takewhile(lambda each: each[0].key != matched, () if match is None else ranking)
        passed_over = (self._rla_facts(*each) for each in nearer if self._passes_over(each[0], level_name))
        others = (each for each in ranking if each[0].key != matched and not self._passes_over(each[0], level_name))
        return LevelFacts(
            level=level_name,
            behaviour=behaviour,
            names=situation.names,
            vector=tuple(situation.vector.tolist()),
            weights=tuple(situation.weights.tolist()),
            euclidean=situation.euclidean,
            nearest=None if match is None else self._rla_facts(match.rla, match.distance, match.radius),
            driver=None if driver is None else self._rla_facts(driver, distances.get(driver.key, math.inf)),
            others=tuple(self._rla_facts(*each) for each in islice(others, self._most)),
            count=self._system.candidate_count(behaviour, level_name),
            radius_share=self._system.radius_share if level_name == BASIC else 1.0,
            passed_over=next(passed_over, None),
        )

    def _passes_over(self, rla: Rla, level_name: str) -> bool:
        """Return whether neighbours answer instead of an RLA, because no teacher can be asked."""
        return level_name == BASIC and self._runtime.level.skip_withdrawn and self._system.passes_over(rla)

    def _ranking(
        self, level_name: str, behaviour: str, vector: NDArray[np.float64], driver: Rla | None
    ) -> tuple[tuple[Rla, float], ...]:
        """Return the nearest RLAs; all of them if the driver is not among the nearest."""
        if self._most is not None:
            ranking = self._system.nearest_first(vector, behaviour, level_name, limit=self._most + 1 + _PASSED_OVER)
            speak = sum(not self._system.passes_over(rla) for rla, _ in ranking)
            shown = driver is None or any(rla.key == driver.key for rla, _ in ranking)
            if shown and speak > self._most:
                return ranking
        return self._system.nearest_first(vector, behaviour, level_name)

    def _radius_of(self, rla: Rla) -> float:
        if rla.level == BASIC:
            return self._system.radius_of(rla)
        if rla.radius is not None:
            return rla.radius
        mid = self._runtime.mid
        return self._system.radius if mid is None else mid.settings.learning.radius

    def _rla_facts(self, rla: Rla, distance: float, radius: float | None = None) -> RlaFacts:
        counted, appraisal = self._runtime.statistics, self._system.appraisal(rla.rla_id)
        rewarded = appraisal.rewards or appraisal.punishments
        return RlaFacts(
            rla_id=rla.rla_id,
            title=rla.title,
            action=rla.action,
            condition=tuple(rla.condition),
            distance=distance,
            radius=self._radius_of(rla) if radius is None else radius,
            acts=tuple(self._lesson_fact(each) for each in self._system.history.about(rla.rla_id)),
            uses=counted.uses.get(rla.rla_id, 0),
            rewards=appraisal.rewards,
            punishments=appraisal.punishments,
            value=float(self._runtime.reinforcement.value(rla.rla_id)) if rewarded else None,
            asks=rla.is_withdrawn,
            leads=self._leads(rla),
            image=rla.image,
        )

    def _leads(self, rla: Rla) -> bool:
        group = self._system.competitors(rla)
        if len(group) < 2:
            return True
        # Of ways from one place the oldest leads, unless a plan chooses: that one is told as the driver.
        return rla == (self._runtime.level.would_answer(group) if rla.level == BASIC else group[0])

    def _lesson_fact(self, record: LessonRecord) -> LessonFact:
        origin = record.event.origin
        return LessonFact(
            text=record.text,
            teacher=origin.teacher,
            phase=int(origin.phase),
            tick=origin.tick,
            stamp=self._stamp_of(origin.command_id),
            undone=record.undone,
            changes=not record.undone and not isinstance(record.event, RlaRewarded),
        )
