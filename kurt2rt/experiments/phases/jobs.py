"""Jobs of the phases study: the training run of phases 1 and 2, and each step after it."""

import shutil
from abc import abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path
from typing import ClassVar

from behaviors.primitives import primitive_speeds
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.experiments.lockstep.curriculum import Report, run_lesson
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.phases.corruption import corrupt, critics_lessons, shuffled
from kurt2rt.experiments.phases.exams import Examiner
from kurt2rt.experiments.phases.outcome import ExamOutcome, JobOutcome
from kurt2rt.experiments.phases.stages import replay_events, stage_outcome, teaching_outcome
from kurt2rt.experiments.phases.steps import PHASE_1, PHASE_2, PHASE_4, TITLES, UNTAUGHT, PhaseStep
from kurt2rt.experiments.study.jobs import StudyJob
from kurt2rt.experiments.study.results import StudyError
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, read_lessons
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now


@dataclass(frozen=True, slots=True, kw_only=True)
class PhasesJob(StudyJob):
    """Job of one step in one robot's training."""

    outcome = JobOutcome
    gives_exams: ClassVar[bool] = True

    @property
    @abstractmethod
    def step(self) -> str:
        """Name of the step."""

    @property
    def stem(self) -> str:
        """Path of result and knowledge, without the top folder and the ending."""
        return self.stem_of(self.step)

    def stem_of(self, step: str) -> str:
        """Return the stem of the same robot's job of another step."""
        return f"{step}/{self.task.name}-{self.seed}"

    def examiner(self, report: Report) -> Examiner:
        """Return the robot's examiner."""
        return Examiner(self.factory, self.robot, self.task, self.seed, report, self.loops.exams)


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstPhasesJob(PhasesJob):
    """Training run of phases 1 and 2, with exams before it, of the knowledge of phase 1, and of all knowledge."""

    gives_lesson: ClassVar[bool] = True

    @property
    def step(self) -> str:
        """Name of the step."""
        return PHASE_2

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"phases 1 and 2, seed {self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the training run, and of three drives in each world, in s."""
        task = self.task
        return task.teaching.duration_s + 3 * len(task.exam.worlds) * task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> JobOutcome:
        """Teach phases 1 and 2 into the file `knowledge`, examine all stages and return the outcome.

        Raises KnowledgeError, SettingsError, LessonLostError.
        """
        robot, task, worlds, examiner = self.robot, self.task, self.task.exam.worlds, self.examiner(report)
        lesson, events = await run_lesson(
            self.factory, robot, task, knowledge, seed=self.seed, report=report, loop=self.loops.lesson
        )
        teachers = await examiner.teachers(worlds)
        answered = list(takewhile(lambda event: event.origin.phase is Phase.SUPERVISED, events))

        async def examined(events: Sequence[TeachingEvent]) -> tuple[ExamOutcome, ...]:
            return await examiner.robots(events, None, worlds, teachers)

        stages = (
            stage_outcome(UNTAUGHT, replay_events(task, robot, []), None, await examined([])),
            stage_outcome(PHASE_1, replay_events(task, robot, answered), None, await examined(answered)),
            stage_outcome(
                PHASE_2, replay_events(task, robot, events), teaching_outcome(lesson, events), await examined(events)
            ),
        )
        return JobOutcome(made_of=self.made_of, seed=self.seed, stages=stages, teachers=teachers)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepJob(PhasesJob):
    """Job of one step after phases 1 and 2."""

    of: PhaseStep
    before: "FirstPhasesJob | StepJob"
    """Job whose knowledge this one continues."""
    first: FirstPhasesJob
    """Job with the teacher's own drives."""
    alike: "FirstPhasesJob | StepJob | None"
    """Job with the number of penalties for random ones."""

    @property
    def step(self) -> str:
        """Name of the step."""
        return self.of.name

    @property
    def name(self) -> str:
        """Name in progress displays."""
        return f"{TITLES[self.of.name]}, seed {self.seed}"

    @property
    def robot_time_s(self) -> float:
        """Time of the training run, and of an exam in each world, in s."""
        taught_s = self.of.plan.duration_s if self.of.plan else 0.0
        drives = 0 if self.of.aside else len(self.of.worlds) + self.of.judges_critic
        return taught_s + drives * self.task.exam.duration_s

    async def measure(self, knowledge: Path, report: Report) -> JobOutcome:
        """Prepare the knowledge in the file `knowledge`, teach the step, examine it and return the outcome.

        Raises StudyError without the result of an earlier step, KnowledgeError, SettingsError, LessonLostError.
        """
        step = self.of
        self._copy_knowledge(knowledge)
        self._prepare(knowledge)
        before = len(read_lessons(knowledge, self.robot, self.task))
        teaching, autonomous_values, plan = None, None, self.plan()
        if plan is not None:
            lesson, events = await run_lesson(
                self.factory, self.robot, self.task, knowledge, seed=self.seed, report=report, plan=plan
            )
            teaching, autonomous_values = teaching_outcome(lesson, events[before:]), lesson.autonomous_values
            if step.aside:
                self._copy_knowledge(knowledge)
                self._add(knowledge, list(critics_lessons(events[before:])))
        with Journal.read_only(knowledge) as journal:
            events, saved = [entry.event for entry in journal.entries()], journal.statistics()
            system = fold_journal(journal, radius=self.task.learning.radius)
        if step.aside:  # the basic level is unchanged, and its exams are, too
            exams = self.results.read(self.before, JobOutcome).stages[-1].exams
        else:
            teachers = self.results.read(self.first, JobOutcome).teachers
            exams = await self.examiner(report).robots(events, saved, step.worlds, teachers, autonomous_values)
        judgements = await self.examiner(report).critic(events, saved) if step.judges_critic else ()
        stage = stage_outcome(step.name, system, teaching, exams, judgements)
        return JobOutcome(made_of=self.made_of, seed=self.seed, stages=(stage,))

    def plan(self) -> LessonPlan | None:
        """Return the phases that the step teaches; None for a step without a training run.

        Random penalties are as many as the judge's penalties in the result of the job `alike`. Raises StudyError
        without that result.
        """
        plan = self.of.plan
        if plan is None or self.alike is None:
            return plan
        (stage,) = self.results.read(self.alike, JobOutcome).stages
        assert stage.teaching is not None
        return replace(plan, blame_by_chance=stage.teaching.blame)

    def _copy_knowledge(self, knowledge: Path) -> None:
        """Copy the knowledge that the step continues."""
        shutil.copyfile(self._left_by(self.of.after), knowledge)

    def _left_by(self, step: str) -> Path:
        """Return the knowledge file of another step. Raises StudyError without the file."""
        stem, folder = self.stem_of(step), self.results.folder
        file = folder / f"knowledge/{stem}.knowledge"
        if not file.exists():
            result = folder / f"results/{stem}.json"
            raise StudyError(f"{file} is gone, and {result} stands", do="delete that too, and run again")
        return file

    def _prepare(self, knowledge: Path) -> None:
        """Add the wrong actions and the critic of phase 4 to the knowledge, if the step begins with them."""
        with Journal.read_only(knowledge) as journal:
            system = fold_journal(journal, radius=self.task.learning.radius)
        lessons: list[TeachingEvent] = []
        if self.of.corrupted:
            primitives = tuple(primitive_speeds(self.task.repertoire))
            lessons += corrupt(system.rlas, primitives, self.of.corrupted, self.seed, self.of.mistakes)
        if self.of.critic != "own":
            lessons += self._critics()
        self._add(knowledge, lessons)

    def _add(self, knowledge: Path, lessons: Sequence[TeachingEvent]) -> None:
        """Append lessons to the file. Raises LessonLostError."""
        if not lessons:
            return
        with JournalWriter(open_for_teaching(knowledge, self.robot, self.task).journal, utc_now) as writer:
            for lesson in lessons:
                writer.submit(lesson)
            writer.flush(timeout_s=30.0)
            refused = [each.error for each in writer.acknowledged() if each.error is not None]
        if refused:
            raise LessonLostError(f"{refused[0]}", where=self.name)

    def _critics(self) -> Iterator[TeachingEvent]:
        taught = self._left_by(PHASE_4)
        if self.of.critic == "taught":
            yield from critics_lessons(read_lessons(taught, self.robot, self.task))
            return
        with Journal.read_only(taught) as journal:
            appraisals = fold_journal(journal, radius=1.0).rlas_at(CRITIC)
        yield from shuffled(appraisals, load_critic(self.task.critic), self.seed, self.robot.cycle_s)


Job = FirstPhasesJob | StepJob
