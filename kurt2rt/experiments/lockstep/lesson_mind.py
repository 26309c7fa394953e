"""Mind of a robot that is taught in a batch: the runtime's own parts, which act between two compiled stretches.

They see each tick as kurt2rt.core.tick shows it to them. Ticks without a command are read from the log, later.
"""

from collections import deque
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.reinforcement.logged_decisions import LoggedDecisions
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.teaching.commands import Command, CommandResult, HoldAction, Resume, Stream
from kurt2rt.core.teaching.inbox import SystemEvent
from kurt2rt.experiments.lockstep.batch_mind import refused
from kurt2rt.runtime import Runtime
from simbridge.contracts.batch_lesson import LessonCause, LessonMode, LessonRobot, TaughtRlas

_UNKNOWN = int(LessonCause.UNKNOWN)


class LessonMind:
    """Runtime's side of a compiled lesson: it carries out commands and gives lessons at the right ticks.

    The compiled `robot` drives by the RLAs that these lessons make.
    """

    def __init__(
        self,
        runtime: Runtime,
        robot: LessonRobot,
        recent: LoggedDecisions,
        store: InMemoryEventStore,
        learners: LearnerTeam | None = None,
    ) -> None:
        """Connect the runtime, whose handler reads `recent`; the robot's log has no tick yet.

        `learners`: those of the runtime, which decide; None: RLAs decide.
        """
        self.runtime = runtime
        self._learners = learners
        self._robot, self._recent, self._store = robot, recent, store
        self._handler = runtime.handler
        width, weights = len(runtime.definition.features), runtime.level.system.weights
        self._values = len(weights) if weights[width:].any() else width
        """Values of a situation that the robot compares."""
        self._conditions: dict[tuple[int, str], NDArray[np.float64]] = {}
        """Weighted features of each RLA that was created, and of its images."""
        self._images = ("", *runtime.level.system.images)
        """The robot's number of an RLA is its id times their number, plus the place of its image here."""
        self._known = 0
        """Newest tick that was counted."""
        self._decided = 0
        """Newest tick before whose decision the handler was called."""
        self._events: deque[tuple[int, TeachingEvent]] = deque()
        """Lessons with their ticks, until those are counted."""
        self._sizes: list[tuple[int, int]] = []
        """Number of RLAs after each lesson, with its tick."""
        self._behaviour = runtime.active_behaviour.behaviour
        """Behaviour whose RLAs the robot has."""
        self._held: tuple[int | None, str] = (None, "")
        self._mode = LessonMode()

    @property
    def events(self) -> list[TeachingEvent]:
        """Lessons so far, oldest first."""
        return self._store.events

    def is_due(self, tick: int) -> bool:
        """Return whether a tick has commands, or a lesson or the end of a hold may be due: `take` must be called."""
        return not self.runtime.inbox.is_empty or (
            self.held_to is not None and (self._handler.holds.next_tick(tick) <= tick or tick > self.held_to)
        )

    @property
    def holds(self) -> bool:
        """Return whether the teacher holds an action."""
        return bool(self._mode.held)

    @property
    def held_to(self) -> int | None:
        """Last tick in which the held action drives without another message; None if none is held."""
        return self._handler.authority.held_until - 1 if self.holds else None

    def held_to_by(self, message: HoldAction, tick: int) -> int:
        """Return the last tick in which the held action drives by a message that arrives in `tick`."""
        return self._handler.authority.lease_end(tick, message.seen_tick) - 1

    def take(self, tick: int) -> list[CommandResult]:
        """Carry out the commands of a tick that was sensed, and the lessons of a held action; return the results."""
        self.count(tick - 1)
        labels = self._label_count
        results: list[CommandResult] = []
        situation = Situation(self._recent.situation(tick), history_frozen=False)
        for command in self.runtime.inbox.pop_all():
            if isinstance(command, Stream):
                self._handler.control.follow(command, tick)
                continue
            assert not isinstance(command, SystemEvent)
            results.append(self._handle(command, situation, tick))
        self._teach(self._handler.teach_driven(tick), tick)
        self._before_decision(tick)
        self._handler.authority.expire(tick)
        behaviour = self.runtime.active_behaviour.behaviour
        if behaviour != self._behaviour:
            self._behaviour = behaviour
            self._robot.select_behaviour(behaviour)
            self._renew_knowledge()
        elif self._events or self._label_count != labels:
            self._renew_knowledge()
        self._order(tick)
        return results

    def rlas_after(self, tick: int) -> int:
        """Return the number of RLAs after a tick that was driven."""
        return next((size for at, size in reversed(self._sizes) if at <= tick), 0)

    def renews(self, message: HoldAction) -> bool:
        """Return whether a message only says that the teacher still holds the action that drives now."""
        return (message.press_id, message.action) == self._held

    def hold_on(self, first: int, last: int, messages: Sequence[tuple[int, HoldAction]]) -> None:
        """Carry out messages of the present hold, and give its lessons, in ticks that were driven already.

        They change nothing of the drive while the hold lasts. `messages`: each with its tick, at most `last`.
        """
        self.count(first - 1)
        waiting, tick = deque(messages), first
        while True:
            tick = min(self._handler.holds.next_tick(tick), waiting[0][0] if waiting else last + 1)
            if tick > last:
                break
            self._recent.newest = tick - 1
            if waiting and waiting[0][0] == tick:
                self._handler.control.follow(waiting.popleft()[1], tick)
            self._teach(self._handler.teach_driven(tick), tick)
            tick += 1
        if self._events:
            self._renew_knowledge()

    def count(self, tick: int) -> None:
        """Let the counts of uses, ends of RLAs and questions reach a tick of the log."""
        if tick <= self._known:
            return
        first, self._known = self._known + 1, tick
        self._follow_standstills(tick)
        self._recent.newest = tick
        self._count_rlas(first, tick)
        self._count_questions(first, tick)

    def _handle(self, command: Command, situation: Situation, tick: int) -> CommandResult:
        assert not isinstance(command, Stream)
        new = not self._handler.was_handled(command.command_id)
        result, events = self._handler.handle(command, situation, tick)
        self._teach(events, tick)
        if new and result.accepted and isinstance(command, Resume):
            self._robot.trust_sensors()
        return result

    def _teach(self, events: Iterable[TeachingEvent], tick: int) -> None:
        for event in events:
            self._events.append((tick, event))
            self._sizes.append((tick, len(self.runtime.level.system)))
            self._store.submit(event)

    def _order(self, tick: int) -> None:
        """Give the robot the orders of the handler as they are now."""
        handler, authority = self._handler, self._handler.authority
        action = authority.held_action if authority.is_manual(tick) else ""
        held = (authority.held_press, action)
        if held != self._held:
            self._held = held
            self._robot.restart_held()
        share = handler.lesson_speed.share if handler.slows_actions else 1.0
        mode = LessonMode(handler.stops.active is not None, action, share)
        if mode != self._mode:
            self._mode = mode
            self._robot.set_mode(mode)

    @property
    def _label_count(self) -> int:
        """Number of labels of the learners; 0 if RLAs decide."""
        return 0 if self._learners is None else len(self._learners.labels)

    def _renew_knowledge(self) -> None:
        """Let the robot drive by what was learned; the next decision may take another action at once."""
        if self._learners is not None:
            self._robot.allow_switch()
        else:
            self._robot.set_rlas(self._taught_rlas())

    def _taught_rlas(self) -> TaughtRlas:
        system, values = self.runtime.level.system, self._values
        rlas = system.candidates(self._behaviour)
        if any(len(system.competitors(rla)) > 1 for rla in rlas):
            raise refused(self.runtime.task, "RLAs on one condition, among which a choice is drawn")
        for rla in rlas:
            if rla.key not in self._conditions:
                weighted = np.array(rla.condition, dtype=np.float64) * system.weights
                self._conditions[rla.key] = weighted[:values]
        return TaughtRlas(
            [rla.rla_id * len(self._images) + self._images.index(rla.image) for rla in rlas],
            [self._conditions[rla.key] for rla in rlas],
            [system.radius_of(rla) for rla in rlas],
            [rla.action for rla in rlas],
        )

    def _before_decision(self, tick: int) -> None:
        log = self._robot.log
        drove, turned = tick > 1 and log.actions[tick - 1] >= 0, log.turned[tick - 1]
        self._handler.before_decision(tick, was_driving=bool(drove), turned=bool(turned))
        self._decided = tick

    def _follow_standstills(self, until: int) -> None:
        """Show the handler each tick, up to `until`, before which the robot or a wheel began to drive or to stand."""
        first = self._decided + 1
        if first > until:
            return
        rows = slice(max(0, first - 2), until)
        drove, turned = self._robot.log.actions[rows] >= 0, self._robot.log.turned[rows]
        changed = (drove[1:] != drove[:-1]) | (turned[1:] != turned[:-1])
        changes = changed.nonzero()[0] + rows.start + 2
        for tick in sorted({first, *changes.tolist()}):
            self._recent.newest = tick - 1
            self._before_decision(tick)
        self._decided = until

    def _count_rlas(self, first: int, last: int) -> None:
        """Count uses, transitions and ends of RLAs, as in each tick."""
        log, runtime = self._robot.log, self.runtime
        driving = log.rlas[first - 1 : last + 1]
        at_full_speed = np.where(log.slow[first - 1 : last + 1], 0, driving)
        changed = (driving[1:] != driving[:-1]) | (at_full_speed[1:] != at_full_speed[:-1])
        ticks = {first, *(changed.nonzero()[0] + first).tolist()}
        # A lesson acts on the tick after it, in which the same RLA may count as another one.
        ticks.update(tick + after for tick, _ in self._events for after in (0, 1) if tick + after <= last)
        for tick in sorted(ticks):
            place = tick - first
            drove, image = divmod(int(driving[place + 1]), len(self._images))
            expected = int(at_full_speed[place + 1]) // len(self._images) or None
            vector, behaviour = self._recent.situation(tick), self._recent.behaviour(tick)
            runtime.expectations.follow(tick, expected, vector, behaviour, self._images[image])
            runtime.statistics.count(drove or None)
            while self._events and self._events[0][0] == tick:
                self._drop_counts(self._events.popleft()[1])

    def _drop_counts(self, event: TeachingEvent) -> None:
        """Drop what was expected of the RLA whose action a lesson changed."""
        invalidated = self.runtime.expectations.on_event(event)
        if invalidated is not None:
            self.runtime.statistics.drop_follow_ups(invalidated)

    def _count_questions(self, first: int, last: int) -> None:
        """Tell the handler of each question's first and last tick, and of the tick after it."""
        asks = self._robot.log.causes[first : last + 1] == _UNKNOWN
        edges = (asks[1:] != asks[:-1]).nonzero()[0]
        for place in sorted({0, len(asks) - 1, *edges.tolist(), *(edges + 1).tolist()}):
            self._handler.on_decision(first + place, asks=bool(asks[place]))
