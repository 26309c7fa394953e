"""Pupils of a comparison: the RLA system as it is shipped, and learners taught in its place."""

from dataclasses import dataclass
from importlib.metadata import version

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.learner.learners import NoLearnerError, find_learner, source_of_learner
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.learner_setting import learner_setting

SHIPPED = "rla"
"""Name of the RLA system with the task's own settings, with which all others are compared."""
PUPILS = (SHIPPED, "1-nn", "k-nn", "weighted-vote", "svm", "tree")
"""Names of those that are compared unless others are named."""
_TITLES = {
    SHIPPED: "RLA, as shipped",
    "rla-door": "RLA through the door",
    "1-nn": "1-NN without R",
    "k-nn": "5-NN with R",
    "weighted-vote": "locally weighted vote with R",
    "svm": "RBF-SVM, margin gate",
    "tree": "decision tree, refitted",
}


@dataclass(frozen=True, slots=True)
class Pupil:
    """Learner that a study compares: the RLA system, or another one by name, with its gate."""

    name: str
    """`SHIPPED`, or the name of a learner."""
    gate: float | None = None
    """Number by which a learner asks, of its own unit; None: its default."""

    @classmethod
    def parse(cls, text: str) -> "Pupil":
        """Return the pupil of a text: a name, or NAME=GATE. Raises NoLearnerError."""
        name, equals, gate = text.partition("=")
        try:
            pupil = cls(name, float(gate) if equals else None)
        except ValueError as error:
            raise NoLearnerError(
                f"{gate!r} is not a number", where=f"learner {name}", do="give NAME=GATE, such as k-nn=0.8"
            ) from error
        if pupil.is_learner:
            find_learner(name)
        elif equals:
            raise NoLearnerError("has no gate", where=f"learner {name}", do="give its name alone")
        return pupil

    @property
    def is_learner(self) -> bool:
        """Return whether it is taught through the door, and not by the RLA level of the robot."""
        return self.name != SHIPPED

    @property
    def title(self) -> str:
        """Name in tables, with a gate that is not the default."""
        title = _TITLES.get(self.name, self.name)
        return title if self.gate is None else f"{title} ({self.gate:g})"

    @property
    def label(self) -> str:
        """Name that file names can hold, such as k-nn-gate-0.8."""
        name = self.name.replace(":", ".")
        return name if self.gate is None else f"{name}-gate-{self.gate:g}"

    @property
    def source(self) -> str:
        """Text that changes with all that decides its results, besides the program. Raises NoLearnerError."""
        if not self.is_learner:
            return self.label
        return f"{self.label} {source_of_learner(self.name)} scikit-learn {version('scikit-learn')}"

    def new_team(self, task: TaskSettings, robot: RobotSettings, seed: int) -> LearnerTeam | None:
        """Return learners of all behaviours of the task that know nothing; None for the RLA system.

        Raises NoLearnerError, and config.settings.SettingsError for settings that do not fit each other.
        """
        if not self.is_learner:
            return None
        setting = learner_setting(task, robot, seed=seed, gate=self.gate)
        return LearnerTeam(self.name, find_learner(self.name), setting, task.behaviours)
