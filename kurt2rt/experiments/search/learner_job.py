"""Job of a search that teaches a learner in place of the RLAs."""

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

from hal.batch_refusal import BatchRefusedError
from kurt2rt.experiments.lockstep.batch_exam import BatchExam
from kurt2rt.experiments.lockstep.batch_mind import require_known_exams
from kurt2rt.experiments.lockstep.curriculum import CurriculumResult, Report, WorldResult, run_drives
from kurt2rt.experiments.lockstep.drive_loop import DriveLoop
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.seed_result import seed_result
from kurt2rt.experiments.rivals.lesson import teach_rival
from kurt2rt.experiments.rivals.rival import Rival
from kurt2rt.experiments.search.jobs import SearchJob
from kurt2rt.experiments.study.seeds import SeedOutcome


@dataclass(frozen=True, slots=True, kw_only=True)
class LearnerSearchJob(SearchJob):
    """Lesson and exams of one robot whose learner has the gate of a trial, and its task the other numbers."""

    rival: Rival

    async def measure(self, knowledge: Path, report: Report) -> SeedOutcome:  # noqa: ARG002 - a learner has no file
        """Teach and examine the robot; return the outcome. Raises NoLearnerError, SettingsError, LessonLostError."""
        factory, robot, task, seed = self.factory, self.robot, self.task, self.seed
        team = self.rival.new_team(task, robot, seed)
        world, seconds = task.teaching.world, task.teaching.duration_s

        def on_progress(done_s: float) -> None:
            report(f"teaching in world {world}", done_s, seconds)

        with closing(factory.open(world, seed, "lesson")) as simulation:
            lesson, _ = await teach_rival(simulation, robot, task, team, (), seed=seed, on_progress=on_progress)
        on_progress(seconds)
        worlds, events = task.exam.worlds, lesson.marks[-1].events
        own = [BatchExam(ExamSetup(each, seed, learners=team), events) for each in worlds]
        policy = [BatchExam(ExamSetup(each, seed, teacher_policy=True)) for each in worlds]
        exams = tuple(
            WorldResult(learned, teacher, learned.verdict(teacher.progress, task.exam.success))
            for learned, teacher in zip(
                await run_drives(factory, robot, task, own, report),
                await run_drives(factory, robot, task, policy, report, self._policy_loop()),
                strict=True,
            )
        )
        result = seed_result(CurriculumResult(lesson.result, exams))
        return SeedOutcome(made_of=self.made_of, lesson=result.lesson, exams=result.exams)

    def _policy_loop(self) -> DriveLoop:
        """Return the batch if it knows the exams, where the policy's own drives are equal and quicker."""
        try:
            require_known_exams(self.robot, self.task)
        except BatchRefusedError:
            return DriveLoop.BUS
        return DriveLoop.BATCH
