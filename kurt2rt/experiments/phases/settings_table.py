"""Table of the settings that phases 3 to 5 were tried out with."""

from collections.abc import Iterator
from typing import Any

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.phases.steps import phases_of
from kurt2rt.experiments.study.table import Table


def settings_sheet(task: TaskSettings) -> Table:
    """All that stands in the sections of these phases, and in the critic's file."""
    of: dict[str, Any] = {
        "phases": phases_of(task).model_dump(mode="json", exclude={"asked"}),
        "reinforcement": task.reinforcement.model_dump(mode="json"),
        "judge": task.judge.model_dump(mode="json") if task.judge else {},
        "critic": load_critic(task.critic).model_dump(mode="json"),
    }
    rows = tuple(_told(of, ""))
    return Table("Settings of phases 3 to 5", ("setting", "value"), rows, words=2)


def _told(value: Any, name: str) -> Iterator[tuple[str, str]]:
    if isinstance(value, dict):
        for key, each in value.items():
            yield from _told(each, f"{name}.{key}" if name else key)
    elif isinstance(value, list) and any(isinstance(each, dict) for each in value):
        for number, each in enumerate(value):
            yield from _told(each, f"{name}.{number}")
    elif isinstance(value, list):
        yield name, ", ".join(map(str, value))
    else:
        yield name, f"{value:g}" if isinstance(value, float) else str(value)
