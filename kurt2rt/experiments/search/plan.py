"""Plan of a search: its task and space, the maker of its jobs, and the files that it leaves."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.lockstep.batch_lesson_settings import require_known_lesson
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams
from kurt2rt.experiments.lockstep.compatibility import require_course
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop
from kurt2rt.experiments.search.job_maker import JobMaker
from kurt2rt.experiments.search.settings import CheckSettings, SearchSettings
from kurt2rt.experiments.search.space import TaskSpace
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.provenance import Fingerprints, Provenance


@dataclass(frozen=True, slots=True)
class SearchPlan:
    """Search that can be run."""

    search: SearchSettings
    space: TaskSpace
    jobs: JobMaker
    made_of: Provenance
    """Provenance of the trials: the shipped settings, the search, its worlds, and the program."""

    @property
    def check(self) -> CheckSettings:
        """Robots and worlds of the check."""
        return self.search.check

    @property
    def folder(self) -> Path:
        """Folder of the results."""
        return self.jobs.parts["results"].folder


def make_plan(
    search: SearchSettings,
    parts: JobParts,
    *,
    changes: Mapping[str, str],
) -> SearchPlan:
    """Check task, space and worlds, and return the plan.

    Args:
        search: what is searched.
        parts: factory, robot and results of the jobs.
        changes: values by dotted key of the task's file, of all trials and of the shipped settings.

    Raises:
        hal.settings.SettingsError: a key, the task or a world does not fit.
        BatchRefusedError: a batch does not know the task.
    """
    factory = parts["factory"]
    space = TaskSpace(search, changes, load_teacher(search.teacher))
    task = space.task(space.shipped)
    robots = [(each, seed) for each in (search.search, search.check) for seed in each.seeds.seeds]
    exams = [(world, seed) for each, seed in robots for world in each.worlds_of(seed)]
    worlds = tuple(dict.fromkeys((task.teaching.world, *(world for world, _ in exams))))
    factory.require_worlds(*worlds)
    require_course(factory, task, worlds)
    if search.lessons is DriveLoop.BATCH:
        require_known_lesson(parts["robot"], task)
    if search.exams is DriveLoop.BATCH:
        require_known_exams(parts["robot"], task)
    fingerprints = Fingerprints(factory, parts["robot"], ("paper", "plain", "phases"))
    # More trials, and another number of them checked, leave each trial as it is.
    decides = search.model_dump_json(exclude={"trials": True, "check": {"best"}})
    return SearchPlan(
        search, space, JobMaker(search, space, parts, fingerprints), fingerprints.of(task, worlds, decides)
    )
