"""Job of a search that teaches a learner in place of the RLAs."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from hal.batch_lesson import LessonFactory
from hal.batch_refusal import BatchRefusedError
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, Report, WorldResult, run_drives
from kurt2rt.experiments.lockstep.drive_loop import ON_BUS, DriveLoop, DriveLoops
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.seed_result import seed_result
from kurt2rt.experiments.rivals.lesson import RivalLesson, teach_rival, teach_rival_in_batch
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.search.jobs import SearchJob
from kurt2rt.experiments.study.seeds import SeedOutcome


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnerSearchJob(SearchJob):
    """Lesson and exams of one robot whose learner has the gate of a trial, and its task the other numbers."""

    rival: Rival

    async def measure(self, knowledge: Path, report: Report) -> SeedOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot; return the outcome. Raises NoLearnerError, SettingsError, LessonLostError."""
        try:
            return await self._measure(self.loops, report)
        except BatchRefusedError:  # a learner failed, or the batch does not know the task
            return await self._measure(ON_BUS, report)

    async def _measure(self, loops: DriveLoops, report: Report) -> SeedOutcome:
        factory, robot, task, seed = self.factory, self.robot, self.task, self.seed
        lesson, team = await self._teach(loops.lesson, report)
        worlds, events = task.exam.worlds, lesson.marks[-1].events
        own = [BatchExam(ExamSetup(each, seed, learners=team), events) for each in worlds]
        policy = [BatchExam(ExamSetup(each, seed, teacher_policy=True)) for each in worlds]
        exams = tuple(
            WorldResult(learned, teacher, learned.verdict(teacher.progress, task.exam.success))
            for learned, teacher in zip(
                await run_drives(factory, robot, task, own, report, loops.exams),
                await run_drives(factory, robot, task, policy, report, loops.exams),
                strict=True,
            )
        )
        result = seed_result(CurriculumResult(lesson.result, exams))
        return SeedOutcome(made_of=self.made_of, lesson=result.lesson, exams=result.exams)

    async def _teach(self, loop: DriveLoop, report: Report) -> tuple[RivalLesson, LearnerTeam]:
        factory, robot, task, seed = self.factory, self.robot, self.task, self.seed
        world, seconds = task.teaching.world, task.teaching.duration_s

        def on_progress(done_s: float) -> None:
            report(f"teaching in world {world}", done_s, seconds)

        team, given = self.rival.new_team(task, robot, seed), None
        if loop is DriveLoop.BATCH and isinstance(factory, LessonFactory):
            given = teach_rival_in_batch(factory, robot, task, team, (), seed=seed, on_progress=on_progress)
            if given is None:  # they were taught a part of the lesson
                team = self.rival.new_team(task, robot, seed)
        if given is None:
            with closing(factory.open(world, seed, "lesson")) as simulation:
                given = await teach_rival(simulation, robot, task, team, (), seed=seed, on_progress=on_progress)
        on_progress(seconds)
        return given[0], team
