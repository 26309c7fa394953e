"""Results that the steps of a tick hand to each other."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

from behaviors.judges.judge import AppraisalFeatures
from hal.robot import GuardResult
from kurt2rt.core.critic.critic import Opinion
from kurt2rt.core.decision.decision import Decision
from kurt2rt.core.decision.standing import Standing, hindrance_after_resume
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.teaching.commands import CommandResult
from kurt2rt.core.teaching.system_events import Input

# The results of the steps are made in every tick: a plain dataclass takes half the time of a named tuple.


@dataclass(slots=True)
class View:
    """Result of the step perceive."""

    situation: Situation
    blind: bool
    appraisal_features: AppraisalFeatures | None
    opinion: Opinion | None


@dataclass(slots=True)
class Choice:
    """Result of the step decide."""

    commands: tuple[Input, ...]
    results: list[CommandResult]
    events: list[TeachingEvent]
    """Lessons of the commands; the step learn adds the robot's own."""
    saving_error: str | None
    decision: Decision
    behaviour: str


@dataclass(slots=True)
class Motion:
    """Result of the step guard."""

    result: GuardResult
    drove_at_s: float
    asks_at_bumper: bool
    turning: bool
    """True if the decided action turns the wheels."""


def tell_hindrance(
    results: Sequence[CommandResult], standing: Standing, guard_result: GuardResult
) -> tuple[CommandResult, ...]:
    """Return the results of a tick's commands; those of resumes say what still holds the robot, if anything does.

    `standing`: after the tick. `guard_result`: of the tick.
    """
    if not any(each.code is ResultCode.RESUMED for each in results):
        return tuple(results)
    hindrance = hindrance_after_resume(standing, guard_result)
    if hindrance is None:
        return tuple(results)
    told = Outcome.of(ResultCode.RESUMED, stands=hindrance.reason, says=hindrance.says)
    return tuple(replace(each, outcome=told) if each.code is ResultCode.RESUMED else each for each in results)
