"""Job of a search that teaches a learner in place of the RLAs."""

from dataclasses import dataclass
from pathlib import Path

from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, Report, WorldResult, run_drives
from kurt2rt.experiments.lockstep.drive_loop import DriveLoops
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.seed_result import seed_result
from kurt2rt.experiments.rivals.lesson import RivalSetup, give_lesson, in_batch_or_on_bus
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.search.jobs import SearchJob
from kurt2rt.experiments.study.seeds import SeedOutcome


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnerSearchJob(SearchJob):
    """Lesson and exams of one robot whose learner has the gate of a trial, and its task the other numbers."""

    rival: Rival

    async def measure(self, knowledge: Path, report: Report) -> SeedOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot; return the outcome. Raises NoLearnerError, SettingsError, LessonLostError."""
        return await in_batch_or_on_bus(lambda loops: self._measure(loops, report), self.loops)

    async def _measure(self, loops: DriveLoops, report: Report) -> SeedOutcome:
        factory, robot, task, seed = self.factory, self.robot, self.task, self.seed
        lesson = await give_lesson(factory, self._new_setup, loops.lesson, report)
        worlds, events = task.exam.worlds, lesson.marks[-1].events
        own = [BatchExam(ExamSetup(each, seed, learners=lesson.setup.team), events) for each in worlds]
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

    def _new_setup(self) -> RivalSetup:
        team = self.rival.new_team(self.task, self.robot, self.seed)
        return RivalSetup(robot=self.robot, task=self.task, seed=self.seed, team=team)
