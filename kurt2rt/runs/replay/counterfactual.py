"""Decisions of a run that would have differed under other knowledge."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

from kurt2rt.core.decision.decision import BY_RLA, DecisionCause
from kurt2rt.core.rla.rla import BASIC, MID
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.replay.counterfactual_policy import (
    CounterfactualPolicy,
    PolicyAnswer,
    PolicyAnswers,
    recorded_answers,
)
from kurt2rt.runs.replay.replay import Replay, empty_run_error
from kurt2rt.runs.replay.run import Run
from kurt2rt.runtime import Runtime

_DECIDES = BY_RLA | {DecisionCause.UNKNOWN, DecisionCause.DOUBT}
"""Causes in which knowledge decides, also where the robot doubts it.

In any other the robot stands for another reason, or a teacher drives.
"""

AnswerSource = Callable[[TickRecord, Runtime], PolicyAnswers]
"""Function that returns the answers of some knowledge to a replayed tick."""


class DifferingStretch(NamedTuple):
    """Consecutive ticks of a run in which other knowledge gives one other answer to one recorded answer."""

    level: str
    from_s: float
    """Time of the first tick since the first tick of the run."""
    to_s: float
    """Time of the last tick."""
    ticks: int
    was: PolicyAnswer
    """Recorded answer at the first tick."""
    would_be: PolicyAnswer
    """Other answer at the first tick."""


@dataclass(frozen=True, slots=True)
class Counterfactual:
    """Numbers and stretches of a run's ticks in which other knowledge would have decided otherwise."""

    ticks: int
    """Compared ticks."""
    decided: int
    """Ticks in which knowledge decided: no teacher drove, and nothing else made the robot stand."""
    other_action: int
    """Decided ticks with another action."""
    would_ask: int
    """Decided ticks with a question instead of an action."""
    would_drive: int
    """Decided ticks with an action instead of a question."""
    mid_otherwise: int
    """Ticks in which the mid level would have commanded otherwise, or asked; 0 without one."""
    stretches: tuple[DifferingStretch, ...]
    """Differences in order of time."""
    trouble: str
    """Reason why part of the run was not compared, in a sentence; empty if all of it was."""

    @property
    def same(self) -> bool:
        """Return whether no decision would have differed."""
        return not self.stretches


def counterfactual(
    run: Run,
    would_be: CounterfactualPolicy,
    was: CounterfactualPolicy | None = None,
    on_entry: Callable[[TickEntry], None] = lambda _: None,
    from_s: float = 0.0,
) -> Counterfactual:
    """Replay a run and compare the answers of two policies to each situation.

    `was`: None: the run's own knowledge. `on_entry`: called for each tick, for progress. `from_s`: earlier ticks, in s
    since the first one, are replayed and not compared. Raises RecordingError.
    """
    replay = Replay(run)
    before: AnswerSource = recorded_answers if was is None else was.answers
    count = _DifferenceCounter()
    for tick in replay:
        at_s, record, runtime = run.elapsed_s(tick.entry), tick.record, replay.runtime
        if at_s >= from_s:
            count.update(at_s, record, before(record, runtime), would_be.answers(record, runtime))
        on_entry(tick.entry)
    found = count.result(run.trouble)
    if not found.ticks:
        raise empty_run_error(run)
    return found


class _DifferenceCounter:
    """Counter of differing ticks, which joins them to stretches."""

    def __init__(self) -> None:
        self._ticks = self._decided = self._other_action = self._would_ask = self._would_drive = self._mid = 0
        self._open: dict[str, DifferingStretch] = {}
        self._stretches: list[DifferingStretch] = []

    def update(self, at_s: float, record: TickRecord, was: PolicyAnswers, would_be: PolicyAnswers) -> None:
        """Compare the answers of one tick, `at_s` since the first one."""
        self._ticks += 1
        decides = record.decision.cause in _DECIDES
        self._decided += decides
        basic = decides and record.decision.asks_at == BASIC
        self._update_level(BASIC, at_s, was.basic, would_be.basic, decides=basic)
        if was.mid is not None and would_be.mid is not None:
            self._update_level(MID, at_s, was.mid, would_be.mid, decides=decides)

    def result(self, trouble: str) -> Counterfactual:
        """Return all counts."""
        stretches = sorted([*self._stretches, *self._open.values()], key=lambda each: (each.from_s, each.level))
        return Counterfactual(
            ticks=self._ticks,
            decided=self._decided,
            other_action=self._other_action,
            would_ask=self._would_ask,
            would_drive=self._would_drive,
            mid_otherwise=self._mid,
            stretches=tuple(stretches),
            trouble=trouble,
        )

    def _update_level(
        self, level: str, at_s: float, was: PolicyAnswer, would_be: PolicyAnswer, *, decides: bool
    ) -> None:
        differs = decides and was.action != would_be.action
        if differs:
            self._count(level, was, would_be)
        stretch = self._open.get(level)
        answers = _identity(was), _identity(would_be)
        if differs and stretch is not None and answers == (_identity(stretch.was), _identity(stretch.would_be)):
            self._open[level] = stretch._replace(to_s=at_s, ticks=stretch.ticks + 1)
            return
        if stretch is not None:
            self._stretches.append(self._open.pop(level))
        if differs:
            self._open[level] = DifferingStretch(level, at_s, at_s, 1, was, would_be)

    def _count(self, level: str, was: PolicyAnswer, would_be: PolicyAnswer) -> None:
        if level == MID:
            self._mid += 1
        elif was.action is None:
            self._would_drive += 1
        elif would_be.action is None:
            self._would_ask += 1
        else:
            self._other_action += 1


def _identity(answer: PolicyAnswer) -> tuple[str | None, int | None]:
    return answer.action, None if answer.rla is None else answer.rla.rla_id
