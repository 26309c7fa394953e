"""Results of resumes, with what still holds the robot in the tick of the resume."""

from collections.abc import Sequence
from dataclasses import replace

from hal.robot import GuardResult
from kurt2rt.core.decision.standing import Standing, hindrance_after_resume
from kurt2rt.core.outcome import Outcome, ResultCode
from kurt2rt.core.teaching.commands import CommandResult


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
