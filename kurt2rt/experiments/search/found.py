"""File of the found settings, with where they came from."""

from pathlib import Path
from typing import Any

import yaml

from kurt2rt.experiments.search.check import CheckedSettings, CheckResult
from kurt2rt.experiments.search.plan import SearchPlan
from kurt2rt.experiments.search.score import RobotScore, effort
from kurt2rt.experiments.search.settings import Objective, Robots
from kurt2rt.experiments.search.tables import verdict_text
from kurt2rt.experiments.study.intervals import RateDifference
from kurt2rt.platform.durable_files import write_durably

_DIGITS = 4


def write_found(plan: SearchPlan, check: CheckResult, command: str, path: Path) -> None:
    """Write the changed keys of the task, each checked trial, and the verdict as YAML to `path`. Raises OSError."""
    search, found = plan.search, check.found
    content = {
        "study": search.name,
        "command": command,
        "date": check.record.date,
        "source": plan.made_of.source,
        "versions": plan.made_of.versions,
        "task": search.task,
        "teacher": search.teacher,
        "objective": search.objective,
        "trials": check.record.trials,
        "search": _robots(search.search),
        "check": _robots(plan.check),
        "shipped": {"values": dict(plan.space.shipped), **_counts(check.shipped, search.objective)},
        "checked": [_checked(each, check) for each in check.checked],
        "verdict": verdict_text(plan, check),
        # Keys as --set takes them; empty if the shipped settings stay.
        "changes": {} if found is None else plan.space.changes(found.values),
    }
    write_durably(path, yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120))


def _robots(robots: Robots) -> dict[str, Any]:
    seeds = robots.seeds.seeds
    return {"seeds": f"{seeds[0]}-{seeds[-1]}", "worlds": list(robots.worlds)}


def _checked(each: CheckedSettings, check: CheckResult) -> dict[str, Any]:
    return {
        "trial": each.label,
        "values": dict(each.values),
        **_counts(each.robots, check.objective),
        "passed_share_difference": _interval(each.passed),
        "effort_difference": _interval(each.effort),
        "is_better": each.is_better,
    }


def _counts(robots: tuple[RobotScore, ...], objective: Objective) -> dict[str, Any]:
    return {
        "passed": sum(each.passed for each in robots),
        "exams": sum(each.exams for each in robots),
        "effort": [effort(each, objective) for each in robots],
    }


def _interval(difference: RateDifference) -> dict[str, float]:
    return {name: round(value, _DIGITS) for name, value in difference._asdict().items()}
