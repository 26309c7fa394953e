"""Schema of `config/rivals/*.yaml`: what is tuned of each rival of a league, and on which robots and worlds."""

from typing import Annotated

from pydantic import Field

from hal.settings import Settings, SettingsError, load_settings
from hal.settings_files import find_config
from kurt2rt.experiments.rivals.rival import TUNED
from kurt2rt.experiments.rivals.tuned import GATE
from kurt2rt.experiments.search.settings import (
    Count,
    Dimension,
    LearnerToSearch,
    Objective,
    Robots,
    SearchSettings,
    SeedRange,
)


class GateRange(Settings):
    """Gate of a learner, of its own unit."""

    first: float
    """Gate of the first trial: the learner's default."""
    low: float
    high: float


class TuningSettings(Settings):
    """Tuning of a league."""

    name: str
    teacher: str
    objective: Objective
    trials: Count
    seeds: SeedRange
    worlds: dict[str, Annotated[tuple[str, ...], Field(min_length=1)]]
    """Worlds of the exams by task; SEED in a name stands for the robot's seed."""
    space: Annotated[tuple[Dimension, ...], Field(min_length=1)]
    """Keys of the task's file that are tuned for every rival."""
    rla_space: tuple[Dimension, ...]
    """Further keys of the RLA system."""
    gates: dict[str, GateRange]
    """Learners by name, with their gates."""

    @property
    def rivals(self) -> tuple[str, ...]:
        """Names of all that are tuned."""
        return (TUNED, *self.gates)

    def search(self, task: str, rival: str, trials: int) -> SearchSettings:
        """Return the search of a rival's settings in a task. Raises SettingsError if nothing of it is tuned."""
        where = f"rivals {self.name}"
        if task not in self.worlds:
            raise SettingsError(
                f"the task {task} is not tuned", where=where, do=f"give one of {', '.join(self.worlds)}"
            )
        if rival not in self.rivals:
            raise SettingsError(f"{rival} is not tuned", where=where, do=f"give one of {', '.join(self.rivals)}")
        gate, learner = self.gates.get(rival), None
        own = self.rla_space
        if gate is not None:
            learner = LearnerToSearch(name=rival, gate=gate.first)
            own = (Dimension(key=GATE, low=gate.low, high=gate.high),)
        return SearchSettings(
            name=f"{rival}_{task}".replace("-", "_"),
            task=task,
            teacher=self.teacher,
            objective=self.objective,
            trials=trials,
            learner=learner,
            search=Robots(seeds=self.seeds, worlds=self.worlds[task]),
            space=(*self.space, *own),
        )


def load_tuning(name_or_path: str) -> TuningSettings:
    """Load the tuning of a league by name (`config/rivals`), or a file by path. Raises SettingsError."""
    return load_settings(find_config("rivals", name_or_path), TuningSettings)
