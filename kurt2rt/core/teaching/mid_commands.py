"""Commands of the mid level: its lessons, the behaviour to follow, and goals."""

from collections import deque
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from kurt2rt.core.decision.decision import ActiveBehaviour, Decision
from kurt2rt.core.mid.mid_level import MidLevel
from kurt2rt.core.outcome import CommandRefusedError, Outcome, RefusalCode, ResultCode
from kurt2rt.core.planning.navigator import Navigator
from kurt2rt.core.rla.events import SituationNamed, TeachingEvent
from kurt2rt.core.rla.rla import MID, Origin
from kurt2rt.core.teaching.commands import BeAt, Correct, NameSituation, Pursue, Seek, StopSeeking, Teach

LONGEST_NAME = 64


class MidSnapshot(NamedTuple):
    """Situation and decision of the mid level, which stay equal from junction to junction."""

    first_tick: int
    vector: NDArray[np.float64]
    """Mid-level situation, shape (d,)."""
    rla_id: int | None
    """Mid-level RLA that commanded; None if the level asked or a teacher commanded."""


class MidHistory:
    """Last 64 snapshots by tick, because a teacher may mean a junction of minutes ago."""

    def __init__(self) -> None:
        self._snapshots: deque[MidSnapshot] = deque(maxlen=64)
        self._newest_tick = -1

    def remember(self, tick: int, vector: NDArray[np.float64], rla_id: int | None) -> None:
        """Add the snapshot of a tick; the oldest is dropped.

        Args:
            tick: number of the tick.
            vector: mid-level situation, shape (d,). It is stored without a copy and must never change: an identical
                object is the same situation.
            rla_id: RLA that commanded; None if the level asked or a teacher commanded.
        """
        self._newest_tick = tick
        last = self._snapshots[-1] if self._snapshots else None
        if last is None or last.vector is not vector or last.rla_id != rla_id:
            self._snapshots.append(MidSnapshot(tick, vector, rla_id))

    @property
    def newest(self) -> MidSnapshot | None:
        """Newest snapshot; None before the first."""
        return self._snapshots[-1] if self._snapshots else None

    def get(self, tick: int) -> MidSnapshot | None:
        """Return the snapshot of a tick; None if it was dropped or is in the future."""
        if tick > self._newest_tick:
            return None
        return next((each for each in reversed(self._snapshots) if each.first_tick <= tick), None)


class MidCommands:
    """Commands of a robot with a mid level: lessons of that level, names of situations, places and goals."""

    def __init__(self, mid: MidLevel, navigator: Navigator) -> None:
        self.mid = mid
        self.passed_at_tick = -1
        """Tick in which the last junction was passed; commands on older states are about that junction."""
        self._navigator = navigator
        self._history = MidHistory()
        self._seen_tick = -1
        """Tick that the teacher had seen at the last goal command."""
        self._planned_tick = -1

    def remember(self, tick: int, decision: Decision) -> None:
        """Add the mid level's decision of a tick to the history; call it after each decision."""
        decided = decision.mid
        if decided is None:
            return
        self._history.remember(tick, self.mid.vector, decided.rla_id)
        if decided.event is not None:
            self.passed_at_tick = tick

    def meant(self, decision_tick: int | None) -> tuple[NDArray[np.float64], int | None]:
        """Return the situation (d,) that a command means by a tick, and the RLA that commanded; None: the present one.

        Raises:
            CommandRefusedError: if the tick was forgotten, or the robot did not know its place then.
        """
        if decision_tick is None:
            moment, vector = self._history.newest, self.mid.vector
        else:
            moment = self._history.get(decision_tick)
            if moment is None:
                raise CommandRefusedError(RefusalCode.TICK_FORGOTTEN, tick=decision_tick)
            vector = moment.vector
        if np.isnan(vector).any():  # an unknown place has no distances
            raise CommandRefusedError(RefusalCode.PLACE_UNKNOWN)
        return vector, None if moment is None else moment.rla_id

    def on_lesson(self, command: Teach | Correct) -> None:
        """Let a new lesson about the present situation replace the teacher's override.

        If another RLA on the same condition wins against the taught one, override the level by the taught action.
        Raises CommandRefusedError if the command's tick was forgotten.
        """
        if isinstance(command, Teach) and command.alternative:
            return  # an alternative does not change the present command
        mid = self.mid
        if not np.array_equal(self.meant(command.decision_tick)[0], mid.vector):
            return
        match = mid.system.match(mid.vector, level=MID)
        if match is None or not match.known or match.rla.action == command.action:
            mid.end_override()
        else:
            mid.override(command.action)

    def name_situation(self, command: NameSituation, origin: Origin) -> tuple[Outcome, TeachingEvent]:
        """Return the outcome and the event that gives a mid-level situation a name.

        Raises CommandRefusedError for a bad name, a forgotten tick, and if the robot did not know its place.
        """
        name = command.name
        if not 0 < len(name) <= LONGEST_NAME or not name.isprintable() or name != name.strip():
            raise CommandRefusedError(RefusalCode.BAD_NAME, name=name, longest=LONGEST_NAME)
        situation = tuple(self.meant(command.decision_tick)[0].tolist())
        return Outcome.of(ResultCode.SITUATION_NAMED, name=name), SituationNamed(name, situation, MID, origin)

    def carry_out(self, command: Seek | StopSeeking | BeAt, tick: int) -> Outcome:
        """Carry out a command in this tick and return the outcome.

        Raises CommandRefusedError for an unknown goal or place, and for a command that a later command or junction
        supersedes.
        """
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if isinstance(command, BeAt):
            return self._locate(command.name, seen_tick)
        if seen_tick < self._seen_tick:
            raise CommandRefusedError(RefusalCode.GOAL_SINCE)
        said = self._seek(command, tick)
        self._seen_tick = seen_tick
        return said

    def _seek(self, command: Seek | StopSeeking, tick: int) -> Outcome:
        if isinstance(command, StopSeeking):
            self._navigator.stop()
            return Outcome(ResultCode.GOAL_DROPPED)
        if tick == self._planned_tick:  # a plan takes a good part of a tick
            raise CommandRefusedError(RefusalCode.GOAL_IN_SAME_TICK)
        status = self._navigator.seek(command.goal)
        self._planned_tick = tick
        return Outcome.of(ResultCode.GOAL_SOUGHT, goal=command.goal.text, status=status.value)

    def _locate(self, name: str, seen_tick: int) -> Outcome:
        if seen_tick < self.passed_at_tick:
            raise CommandRefusedError(RefusalCode.JUNCTION_PASSED)
        self._navigator.localise(name)
        return Outcome.of(ResultCode.LOCATED, name=name)


class BehaviourSelection:
    """Selection in the order in which teachers saw the robot; a late command on an older state is refused."""

    def __init__(self, active_behaviour: ActiveBehaviour, mid: MidCommands | None) -> None:
        """`mid`: commands of the mid level; None: the teacher alone selects."""
        self._active_behaviour = active_behaviour
        self._mid = mid
        self._seen_tick = -1
        """Tick that the teacher had seen at the last selection."""

    def select(self, command: Pursue, tick: int) -> Outcome:
        """Select the behaviour of a command from `tick` on and return the outcome.

        Raises CommandRefusedError for an unknown behaviour, and if the teacher saw a state older than the last
        selection or the last junction.
        """
        wanted, mid = self._active_behaviour, self._mid
        seen_tick = tick if command.seen_tick is None else command.seen_tick
        if seen_tick < self._seen_tick:
            raise CommandRefusedError(RefusalCode.BEHAVIOUR_SINCE, behaviour=wanted.behaviour)
        if mid is not None and seen_tick < mid.passed_at_tick:
            raise CommandRefusedError(RefusalCode.JUNCTION_PASSED)
        if mid is None:
            wanted.select(command.behaviour)
        else:
            mid.mid.override(command.behaviour)
        self._seen_tick = seen_tick
        code = ResultCode.BEHAVIOUR_WANTED if mid is None else ResultCode.BEHAVIOUR_WANTED_TO_JUNCTION
        return Outcome.of(code, behaviour=command.behaviour)
