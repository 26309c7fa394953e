"""Rivals of a league: the RLA system as it is shipped, the paper's plain reading of it, and learners."""

from dataclasses import dataclass, replace
from importlib.metadata import version

from hal.robot_settings import RobotSettings
from kurt2rt.core.learner.learner import LearnerFactory
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.task_settings import TaskSettings, taught_by
from kurt2rt.experiments.lockstep.learner_setting import learner_setting
from kurt2rt.experiments.rivals.agents.rows import AGENTS, PACKAGES, agent_title
from kurt2rt.experiments.rivals.holds.rows import HELD
from kurt2rt.experiments.rivals.holds.rows import TITLES as HOLD_TITLES
from kurt2rt.experiments.rivals.registry import NoLearnerError, find_learner, learner_names, source_of_learner
from kurt2rt.experiments.rivals.signals.rows import REWARDED
from kurt2rt.experiments.rivals.signals.rows import TITLES as SIGNAL_TITLES
from kurt2rt.experiments.rivals.tuned import GATE, TunedRival

SHIPPED = "rla"
"""Name of the RLA system with the task's own settings, with which all others are compared."""
PLAIN = "rla-plain"
TUNED = "rla-tuned"
"""Name of the RLA system with as much tuning as the learners, and the weights of the task, as they have."""
ACTS = "rla-acts"
"""Name of the RLA system as shipped that acts beyond R in exams, where the shipped one stands."""
ASKS_AT_RANDOM = "vote-asks-at-random"
"""Name of the vote without a gate whose robot asks at random."""
_FAR = 1000.0
"""Factor of R in exams of `ACTS`: farther than any situation."""
_RLA_SYSTEMS = (SHIPPED, PLAIN, TUNED, ACTS, HELD, REWARDED)
"""Variants that are taught by the RLA level of the robot."""
_DOOR = ("rla-door", "rla-vote", "rla-svm")
"""Variants of the RLA system that are taught through the door of the learners."""
_LEARNING = "learning."
_TITLES = {
    SHIPPED: "RLA, as shipped",
    PLAIN: "RLA, plain reading of the paper",
    TUNED: "RLA, tuned as the others",
    ACTS: "RLA, acts beyond R in exams",
    "rla-door": "RLA through the door",
    "rla-vote": "RLA through the door, vote of RLAs within R",
    "rla-svm": "RLA through the door, SVM of the RLAs",
    "1-nn": "1-NN without R",
    "k-nn": "5-NN with R",
    "weighted-vote": "locally weighted vote with R",
    "vote-without-gate": "weighted vote, never asks",
    ASKS_AT_RANDOM: "weighted vote, asks at random",
    "gp": "Gaussian process, variance gate",
    "svm": "RBF-SVM, margin gate",
    "tree": "decision tree, refitted",
    "forest": "random forest, vote gate",
    "hoeffding": "Hoeffding tree, vote gate",
    "arf": "adaptive random forest, vote gate",
    "mlp-ensemble": "five networks, gate on their doubt",
}


@dataclass(frozen=True, slots=True)
class Rival:
    """Row of the league."""

    name: str
    """Name of the RLA system, or of a learner."""
    gate: float | None = None
    """Number by which a learner asks, of its own unit, or robot life of an agent in s; None: its default."""
    tuned: tuple[tuple[str, float], ...] = ()
    """Learning settings of the task that were tuned for this rival, by their names; empty: the task's own."""

    @classmethod
    def parse(cls, text: str) -> "Rival":
        """Return the rival of a text: a name, or NAME=GATE. Raises NoLearnerError."""
        name, equals, gate = text.partition("=")
        try:
            rival = cls(name, float(gate) if equals else None)
        except ValueError as error:
            raise NoLearnerError(
                f"{gate!r} is no number", where=f"learner {name}", do="give NAME=GATE, such as k-nn=0.8"
            ) from error
        if not (rival.is_learner or rival.is_agent) and equals:
            raise NoLearnerError("has no gate", where=f"learner {name}", do="give its name alone")
        if rival.is_learner:
            find_learner(name)
        return rival

    @classmethod
    def of_learner(cls, name: str, gate: float) -> "Rival":
        """Return a learner with a gate, dimensionless or in counts as it says. Raises NoLearnerError without one."""
        rival = cls(name, gate)
        rival.factory()
        return rival

    @property
    def is_learner(self) -> bool:
        """Return whether the rival is taught through the door, and not by the RLA level of the robot."""
        return self.name not in _RLA_SYSTEMS and not self.is_agent

    @property
    def is_agent(self) -> bool:
        """Return whether the rival is trained by its own trials, for a robot life of its own."""
        return self.name in AGENTS

    @property
    def is_rla_system(self) -> bool:
        """Return whether the rival is a variant of the RLA system, so that no claim counts it as another learner."""
        return self.name in _RLA_SYSTEMS or self.name in _DOOR

    @property
    def is_held(self) -> bool:
        """Return whether a teacher in charge teaches the rival. Raises NoLearnerError."""
        return self.name == HELD or (self.is_learner and hasattr(self.factory(), "charge"))

    @property
    def is_rewarded(self) -> bool:
        """Return whether the rival is taught by rewards. Raises NoLearnerError."""
        return self.name == REWARDED or (self.is_learner and hasattr(self.factory(), "signal"))

    @property
    def title(self) -> str:
        """Name in tables, with a gate that is not the default."""
        if self.is_agent:
            return agent_title(self.name, self.gate)
        title = (_TITLES | HOLD_TITLES | SIGNAL_TITLES).get(self.name, self.name)
        return title if self.gate is None or self.tuned else f"{title} ({self.gate:g})"

    @property
    def label(self) -> str:
        """Name in file names."""
        name = self.name.replace(":", ".") + ("-tuned" if self.tuned else "")
        number = "life" if self.is_agent else "gate"
        return name if self.gate is None else f"{name}-{number}-{self.gate:g}"

    @property
    def source(self) -> str:
        """Text that changes with all that decides the rival's results, besides the program. Raises NoLearnerError."""
        if self.is_agent:
            return " ".join([self.label, *(f"{each} {version(each)}" for each in PACKAGES)])
        if not self.is_learner:
            return self.label
        packages = " ".join(f"{name} {version(name)}" for name in ("scikit-learn", "river"))
        return f"{self.label} {source_of_learner(self.name)} {packages if self.name in learner_names() else ''}"

    def task(self, task: TaskSettings) -> TaskSettings:
        """Return the task with the learning settings of this rival, tuned or its own."""
        if self.tuned:
            learning = task.learning.model_copy(update=dict(self.tuned))
            return task.model_copy(update={"learning": learning})
        if self.name != PLAIN:
            return task
        return taught_by(task.model_copy(update={"learning": task.plain}), task.teaching.profile)

    def examined(self, task: TaskSettings) -> TaskSettings:
        """Return the task with the settings of this rival's exams."""
        if self.name != ACTS:
            return task
        far = task.learning.model_copy(update={"radius": _FAR * task.learning.radius})
        return task.model_copy(update={"learning": far})

    def tuned_by(self, found: TunedRival | None) -> "Rival":
        """Return the rival with tuned settings; a gate that was asked for stays. None: as it is."""
        if found is None:
            return self
        values = {key.removeprefix(_LEARNING): value for key, value in found.values.items() if key != GATE}
        gate = found.values.get(GATE) if self.gate is None else self.gate
        return replace(self, gate=gate, tuned=tuple(sorted(values.items())))

    def factory(self) -> LearnerFactory:
        """Return the maker of the learner. Raises NoLearnerError."""
        return find_learner(self.name)

    def new_team(
        self, task: TaskSettings, robot: RobotSettings, seed: int, make: LearnerFactory | None = None
    ) -> LearnerTeam:
        """Return learners of all behaviours of the task that know nothing; `make`: in place of the rival's own.

        Raises NoLearnerError, and hal.settings.SettingsError for settings that do not fit each other.
        """
        setting = learner_setting(task, robot, seed=seed, gate=self.gate)
        return LearnerTeam(self.name, make or self.factory(), setting, task.behaviours)
