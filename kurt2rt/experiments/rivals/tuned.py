"""Tuned settings of rivals, as `kurt2rt tune` leaves them in a YAML file."""

from typing import Annotated

from pydantic import Field

from hal.settings import Settings, load_settings
from hal.settings_files import find_config

GATE = "gate"
"""Key of the number by which a learner asks, which is not in the task's file."""


class TunedRival(Settings):
    """Settings of a rival in one task: those of its best trial."""

    task: str
    rival: str
    values: dict[str, float]
    """Value by key of the task's file; `gate` is the number by which the rival asks."""
    trial: int
    """Number of the trial; 0 has the values that the rival and the task had before."""
    score: float
    """Share of exams passed, and a little for few presses, dimensionless (`search/score.py`)."""
    first_score: float
    """Score of trial 0."""


class TunedRivals(Settings):
    """All that one tuning left, with where it came from."""

    league: str
    command: str
    date: str
    source: str
    versions: str
    teacher: str
    trials: Annotated[int, Field(ge=1)]
    seeds: str
    rivals: tuple[TunedRival, ...] = ()

    def of(self, task: str, rival: str) -> TunedRival | None:
        """Return the settings of a rival in a task; None if it was not tuned there."""
        return next((each for each in self.rivals if (each.task, each.rival) == (task, rival)), None)


def load_tuned(name_or_path: str) -> TunedRivals:
    """Load a file of `config/rivals/tuned` by name, or one by its path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("rivals/tuned", name_or_path), TunedRivals)
