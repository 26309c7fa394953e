"""One robot's work in pieces that can be done apart: the lesson of phases 1 and 2, and each step after it."""

import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path

import anyio

from hal.robot_settings import RobotSettings
from hal.simulation import SimulationFactory
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.rla.rla import CRITIC, Phase, TeachingEvent
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.curriculum import run_lesson
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.lockstep.primitives import primitives
from kurt2rt.experiments.phases.corruption import corrupt, critics_lessons, shuffled
from kurt2rt.experiments.phases.event_replay import folded
from kurt2rt.experiments.phases.exams import Examiner
from kurt2rt.experiments.phases.lesson_summary import told
from kurt2rt.experiments.phases.outcome import ExamOutcome, JobOutcome, Judgement, StageOutcome, TeachingOutcome
from kurt2rt.experiments.phases.steps import PHASE_1, PHASE_2, PHASE_4, TITLES, UNTAUGHT, PhaseStep
from kurt2rt.experiments.study.pool import Tell
from kurt2rt.experiments.study.progress_sum import ProgressSum
from kurt2rt.experiments.study.provenance import Provenance
from kurt2rt.experiments.study.results import Results, StudyError
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, read_lessons
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now


@dataclass(frozen=True, slots=True)
class Robot:
    """One seed: where it is taught and where what it comes to is kept."""

    stage: SimulationFactory
    settings: RobotSettings
    task: TaskSettings
    seed: int
    results: Results

    def result_of(self, name: str) -> str:
        """Path of a job's result within the folder of results."""
        return f"results/{name}/{self.task.name}-{self.seed}.json"

    def knowledge_of(self, name: str) -> str:
        """Path of what it knows after a step, within the folder of results."""
        return f"knowledge/{name}/{self.task.name}-{self.seed}.knowledge"

    def examiner(self, time: ProgressSum) -> Examiner:
        """Its examiner."""
        return Examiner(self.stage, self.settings, self.task, self.seed, time.report)


@dataclass(frozen=True, slots=True)
class TaughtJob:
    """Phases 1 and 2: the task's own lesson, with exams before it, of what phase 1 taught, and of all."""

    robot: Robot
    made_of: Provenance

    @property
    def step(self) -> str:
        """The step that it is."""
        return PHASE_2

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"phases 1 and 2, seed {self.robot.seed}"

    @property
    def file(self) -> str:
        """Path within the folder of results."""
        return self.robot.result_of(PHASE_2)

    @property
    def outcome(self) -> type[JobOutcome]:
        """Schema of its result."""
        return JobOutcome

    @property
    def robot_time_s(self) -> float:
        """The lesson, and in each world two exams and the teacher's own drive."""
        task = self.robot.task
        return task.teaching.duration_s + 3 * len(task.exam.worlds) * task.exam.duration_s

    def run(self, tell: Tell) -> None:
        """Teach, examine, keep the result and the knowledge."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        robot, time = self.robot, ProgressSum(tell)
        task, results, worlds = robot.task, robot.results, robot.task.exam.worlds
        examiner = robot.examiner(time)
        with results.scratch() as folder:
            knowledge = folder / "knowledge"
            lesson, events = await run_lesson(
                robot.stage, robot.settings, task, knowledge, seed=robot.seed, report=time.report
            )
            teachers = await examiner.teachers(worlds)
            answered = list(takewhile(lambda event: event.origin.phase is Phase.SUPERVISED, events))

            async def examined(events: Sequence[TeachingEvent]) -> tuple[ExamOutcome, ...]:
                return await examiner.robots(events, None, worlds, teachers)

            stages = (
                _stage(UNTAUGHT, folded(task, robot.settings, []), None, await examined([])),
                _stage(PHASE_1, folded(task, robot.settings, answered), None, await examined(answered)),
                _stage(PHASE_2, folded(task, robot.settings, events), told(lesson, events), await examined(events)),
            )
            results.keep(knowledge, robot.knowledge_of(PHASE_2))
        results.write(self, JobOutcome(made_of=self.made_of, seed=robot.seed, stages=stages, teachers=teachers))


@dataclass(frozen=True, slots=True)
class StepJob:
    """A step after those."""

    robot: Robot
    of: PhaseStep
    before: "TaughtJob | StepJob"
    """The job of the step that it goes on from."""
    first: TaughtJob
    """Holds the teacher's own drives."""
    alike: "TaughtJob | StepJob | None"
    """The job whose robot was blamed as often as this one shall be by chance."""
    made_of: Provenance

    @property
    def step(self) -> str:
        """The step that it is."""
        return self.of.name

    @property
    def name(self) -> str:
        """What is shown while it runs."""
        return f"{TITLES[self.of.name]}, seed {self.robot.seed}"

    @property
    def file(self) -> str:
        """Path within the folder of results."""
        return self.robot.result_of(self.of.name)

    @property
    def outcome(self) -> type[JobOutcome]:
        """Schema of its result."""
        return JobOutcome

    @property
    def robot_time_s(self) -> float:
        """What is taught, and an exam in each world."""
        taught_s = self.of.plan.duration_s if self.of.plan else 0.0
        drives = 0 if self.of.aside else len(self.of.worlds) + self.of.judges_critic
        return taught_s + drives * self.robot.task.exam.duration_s

    def run(self, tell: Tell) -> None:
        """Make the set, teach, examine, keep the result and the knowledge."""
        anyio.run(self._run, tell)

    async def _run(self, tell: Tell) -> None:
        robot, step, time = self.robot, self.of, ProgressSum(tell)
        results = robot.results
        with results.scratch() as folder:
            knowledge = folder / "knowledge"
            self._copy_knowledge(knowledge)
            self._prepare(knowledge)
            before = len(read_lessons(knowledge, robot.settings, robot.task))
            teaching, autonomous_values, plan = None, None, self.plan()
            if plan is not None:
                lesson, events = await run_lesson(
                    robot.stage,
                    robot.settings,
                    robot.task,
                    knowledge,
                    seed=robot.seed,
                    report=time.report,
                    plan=plan,
                )
                teaching, autonomous_values = told(lesson, events[before:]), lesson.autonomous_values
                if step.aside:
                    self._copy_knowledge(knowledge)
                    self._add(knowledge, list(critics_lessons(events[before:])))
            with Journal.read_only(knowledge) as journal:
                events, saved = [entry.event for entry in journal.entries()], journal.statistics()
                system = fold_journal(journal, radius=robot.task.learning.radius)
            if step.aside:  # what drives is as it was, and so are its exams
                exams = results.read(self.before, JobOutcome).stages[-1].exams
            else:
                teachers = results.read(self.first, JobOutcome).teachers
                exams = await robot.examiner(time).robots(events, saved, step.worlds, teachers, autonomous_values)
            judgements = await robot.examiner(time).critic(events, saved) if step.judges_critic else ()
            results.keep(knowledge, robot.knowledge_of(step.name))
        stage = _stage(step.name, system, teaching, exams, judgements)
        results.write(self, JobOutcome(made_of=self.made_of, seed=robot.seed, stages=(stage,)))

    def plan(self) -> LessonPlan | None:
        """What is taught; who blames by chance does so as often as this robot was blamed with good reason.

        Raises StudyError where that is not done yet.
        """
        plan = self.of.plan
        if plan is None or self.alike is None:
            return plan
        (stage,) = self.robot.results.read(self.alike, JobOutcome).stages
        assert stage.teaching is not None
        return replace(plan, blame_by_chance=stage.teaching.blame)

    def _copy_knowledge(self, knowledge: Path) -> None:
        """What the step goes on from."""
        shutil.copyfile(self._left_by(self.of.after), knowledge)

    def _left_by(self, step: str) -> Path:
        """Knowledge that another step left. Raises StudyError where its result stands and this is gone."""
        robot = self.robot
        file = robot.results.folder / robot.knowledge_of(step)
        if not file.exists():
            result = robot.results.folder / robot.result_of(step)
            raise StudyError(f"{file} is gone, and {result} stands", do="delete that too, and run again")
        return file

    def _prepare(self, knowledge: Path) -> None:
        """Wrong actions and the critic of phase 4, where the step begins with them."""
        robot = self.robot
        with Journal.read_only(knowledge) as journal:
            system = fold_journal(journal, radius=robot.task.learning.radius)
        lessons: list[TeachingEvent] = []
        if self.of.corrupted:
            lessons += corrupt(
                system.rlas, primitives(robot.task.repertoire), self.of.corrupted, robot.seed, self.of.mistakes
            )
        if self.of.critic != "own":
            lessons += self._critics()
        self._add(knowledge, lessons)

    def _add(self, knowledge: Path, lessons: Sequence[TeachingEvent]) -> None:
        """Write lessons behind those that the file holds."""
        if not lessons:
            return
        robot = self.robot
        with JournalWriter(open_for_teaching(knowledge, robot.settings, robot.task).journal, utc_now) as writer:
            for lesson in lessons:
                writer.submit(lesson)
            writer.flush(timeout_s=30.0)
            refused = [each.error for each in writer.acknowledged() if each.error is not None]
        if refused:
            raise LessonLostError(f"{refused[0]}", where=self.name)

    def _critics(self) -> Iterator[TeachingEvent]:
        robot = self.robot
        taught = self._left_by(PHASE_4)
        if self.of.critic == "taught":
            yield from critics_lessons(read_lessons(taught, robot.settings, robot.task))
            return
        with Journal.read_only(taught) as journal:
            appraisals = fold_journal(journal, radius=1.0).rlas_at(CRITIC)
        yield from shuffled(appraisals, load_critic(robot.task.critic), robot.seed, robot.settings.can.cycle_s)


Job = TaughtJob | StepJob


def _stage(
    name: str,
    system: RlaSystem,
    teaching: TeachingOutcome | None,
    exams: tuple[ExamOutcome, ...],
    judgements: tuple[Judgement, ...] = (),
) -> StageOutcome:
    return StageOutcome(
        name=name,
        rlas=len(system),
        appraisals=len(system.rlas_at(CRITIC)),
        knowledge_hash=system.knowledge_hash(),
        teaching=teaching,
        exams=exams,
        still_withdrawn=sum(rla.is_withdrawn for rla in system.rlas),
        judgements=judgements,
    )
