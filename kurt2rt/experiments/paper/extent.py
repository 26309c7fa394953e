"""Extent of the paper's experiments in one run."""

from dataclasses import dataclass

from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.paper.settings import GrowthSettings, PaperSettings, UnseenSettings


@dataclass(frozen=True, slots=True)
class Extent:
    """Limits of tasks, worlds and times; settings of learning stay."""

    tasks: tuple[str, ...] | None = None
    """Tasks unless the user names others; None: all."""
    most_teaching_s: float | None = None
    most_exam_s: float | None = None
    most_unseen: int | None = None
    most_radii: int | None = None
    most_robots: int | None = None
    """Robots for each radius."""
    most_growth_s: float | None = None

    @property
    def is_whole(self) -> bool:
        """True if nothing is left out."""
        return self == WHOLE

    def task(self, task: TaskSettings) -> TaskSettings:
        """Return the task with less time; both phases of training are shortened in proportion."""
        teaching, exam = task.teaching, task.exam
        if self.most_teaching_s is not None and teaching.duration_s > self.most_teaching_s:
            share = self.most_teaching_s / teaching.duration_s
            shorter = {
                name: float(round(getattr(teaching, name) * share)) for name in ("supervised_s", "corrections_s")
            }
            teaching = teaching.model_copy(update=shorter)
        if self.most_exam_s is not None and exam.duration_s > self.most_exam_s:
            exam = exam.model_copy(update={"duration_s": self.most_exam_s})
        return task.model_copy(update={"teaching": teaching, "exam": exam})

    def paper(self, paper: PaperSettings) -> PaperSettings:
        """Return the settings of the study with fewer generated worlds and less growth."""
        experiments = tuple(each.model_copy(update={"unseen": self._unseen(each.unseen)}) for each in paper.experiments)
        return paper.model_copy(update={"experiments": experiments, "growth": self._growth(paper.growth)})

    def _unseen(self, unseen: UnseenSettings | None) -> UnseenSettings | None:
        if unseen is None or self.most_unseen is None:
            return unseen
        return unseen.model_copy(update={"count": min(unseen.count, self.most_unseen)})

    def _growth(self, growth: GrowthSettings) -> GrowthSettings:
        update: dict[str, object] = {}
        if self.most_radii is not None:
            update["radii"] = growth.radii[-self.most_radii :]
        if self.most_robots is not None:
            update["robots"] = min(growth.robots, self.most_robots)
        if self.most_growth_s is not None:
            update["duration_s"] = min(growth.duration_s, self.most_growth_s)
        return growth.model_copy(update=update)


WHOLE = Extent()
QUICK = Extent(
    tasks=("wall_following", "circle", "eight", "streets"),
    most_teaching_s=60.0,
    most_exam_s=20.0,
    most_unseen=2,
    most_radii=3,
    most_robots=2,
    most_growth_s=60.0,
)
"""Extent of a test of the program; its numbers say nothing about the paper."""
