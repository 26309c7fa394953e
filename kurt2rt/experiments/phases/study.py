"""Phases study: every step of every robot's training as a job, with the exams after it."""

import shutil
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import takewhile
from pathlib import Path
from typing import ClassVar, NamedTuple

from behaviors.metrics.task_metric import TaskMetric
from behaviors.repertoire import primitive_speeds
from config.settings import Settings
from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import critic_of, load_critic
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.rla.condition import Space
from kurt2rt.core.rla.events import ActionWithdrawn, LessonUndone, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Phase
from kurt2rt.core.rla.rla_system import RlaSystem
from kurt2rt.core.rla.statistics import Statistics
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.curriculum import Report, run_drives
from kurt2rt.experiments.lockstep.drive_row import DriveRow
from kurt2rt.experiments.lockstep.engine import Engine
from kurt2rt.experiments.lockstep.exam import ExamSetup
from kurt2rt.experiments.lockstep.lesson import LessonCounts, TrainingResult
from kurt2rt.experiments.lockstep.lesson_keeping import LessonLostError
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan
from kurt2rt.experiments.phases.steps import (
    Judgement,
    PhaseStep,
    Step,
    corrupt,
    critic_lessons,
    phases_of,
    shortened,
    shuffled,
    steps_of,
)
from kurt2rt.experiments.study.jobs import JobParts, Outcome, StudyError, StudyJob, require_places
from kurt2rt.experiments.study.provenance import Fingerprints, Provenance
from kurt2rt.experiments.study.study_plan import EngineRequest, StudyPlan
from kurt2rt.knowledge.journal.fold import fold_journal
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import open_for_teaching, read_lessons
from kurt2rt.knowledge.journal.writer import JournalWriter, utc_now


class TeachingOutcome(LessonCounts):
    """Counts of one step's training run, which the phases study stores."""

    withdrawn: int
    """Actions that were withdrawn because their value fell."""
    critics_changes: int
    """Lessons that the critic gave itself."""
    rolled_back: int
    """Lessons of the critic that were undone because its score fell."""

    @property
    def interventions(self) -> int:
        """Number of interventions by a person: after collisions, rescues and latched stops."""
        return self.collisions + self.rescues + self.alarms


class StageOutcome(Settings):
    """Stored state of a robot after one step: its knowledge, how it was taught, and its exams."""

    name: Step
    rlas: int
    appraisals: int
    """RLAs of its critic."""
    knowledge_hash: str
    teaching: TeachingOutcome | None
    """None: nothing was taught since the stage before."""
    exams: tuple[DriveRow, ...]
    still_withdrawn: int = 0
    """RLAs with a withdrawn action: they ask, and exams skip them."""
    judgements: tuple[Judgement, ...] = ()
    """Pairs of opinions, if the critic was only judged."""


class JobOutcome(Outcome):
    """Stored outcome of one job of the phases study: its steps, and the drives of the teacher's policy."""

    stages: tuple[StageOutcome, ...]
    teachers: tuple[DriveRow, ...] = ()
    """Drives of the teacher's own policy; of the first job alone."""


def _system_of(task: TaskSettings, robot: RobotSettings, events: Iterable[TeachingEvent]) -> RlaSystem:
    """Return the RLA system with all its levels, for counting: it does not match by the task's weights."""
    dimensions = load_situation(task.situation, robot.infrared.names).dimensions
    critic = Space(len(load_critic(task.critic).names), 1.0, None)
    system = RlaSystem(dimensions, task.learning.radius, others={CRITIC: critic})
    system.apply_all(events)
    return system


def _teaching_outcome(lesson: TrainingResult, events: Sequence[TeachingEvent]) -> TeachingOutcome:
    """Return the stored counters of a training run; `events`: those of this run."""
    own = [event for event in events if event.origin.teacher == CRITIC]
    undone = sum(isinstance(event, LessonUndone) for event in own)
    return TeachingOutcome(
        **dict(lesson.counts),
        withdrawn=sum(isinstance(event, ActionWithdrawn) for event in events),
        critics_changes=len(own) - undone,
        rolled_back=undone,
    )


def _stage_outcome(
    name: Step,
    system: RlaSystem,
    teaching: TeachingOutcome | None,
    exams: tuple[DriveRow, ...],
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


@dataclass(frozen=True, slots=True, kw_only=True)
class PhasesJob(StudyJob):
    """Job of one step in one robot's training. In its exams a stuck robot is rescued and drives on."""

    outcome = JobOutcome
    gives_exams: ClassVar[bool] = True

    async def drive_teacher(self, report: Report) -> tuple[DriveRow, ...]:
        """Let the teacher's own policy drive in each world of the exam; return the drives in order.

        Raises SettingsError if task and world do not fit.
        """
        setups = [ExamSetup(each, self.seed, teacher_policy=True, stuck_ends=False) for each in self.task.exam.worlds]
        drives = await self._drive(setups, report, self.engines.exams)
        return tuple(each.stored().as_measure() for each in drives)

    async def examine(self, exam: ExamSetup, teachers: Sequence[DriveRow], report: Report) -> tuple[DriveRow, ...]:
        """Return an exam of the RLAs of `exam` in the world of each of `teachers`, judged by that drive of the policy.

        Raises SettingsError if task and world do not fit, UnknownActionError and UnknownBehaviourError if the knowledge
        does not.
        """
        drives = await self._drive([replace(exam, world=each.world) for each in teachers], report, self.engines.exams)
        return tuple(
            drive.stored().judged_by(teacher.progress, self.task.exam.success)
            for drive, teacher in zip(drives, teachers, strict=True)
        )

    async def judge_critic(self, exam: ExamSetup, report: Report) -> tuple[Judgement, ...]:
        """Drive in the setup's world without learning, and return the opinions of critic and judge.

        Raises SettingsError if task and world do not fit.
        """
        assert self.task.judge is not None
        judge, ticks = self.task.judge.build(), Counter[tuple[int, int | None]]()

        def on_tick(record: TickRecord, _metric: TaskMetric) -> None:
            if record.appraisal_features is not None and record.decision.driving:
                said = None if record.opinion is None else record.opinion.said
                ticks[judge.judge(record.appraisal_features), said] += 1

        # A batch has no record of each tick.
        await self._drive([replace(exam, appraises=True, on_tick=on_tick)], report, Engine.CAN)
        pairs = sorted(ticks.items(), key=str)
        return tuple(Judgement(judged=judged, said=said, ticks=count) for (judged, said), count in pairs)

    def exam_of(
        self, events: Sequence[TeachingEvent], saved: Statistics | None = None, alone: Statistics | None = None
    ) -> ExamSetup:
        """Return the exam of this knowledge in the world of the training.

        `saved`: values that rewards had given; `alone`: values of phase 5; None: none.
        """
        # A robot without knowledge only stands: its exam need not last.
        world, stuck_ends = self.task.teaching.world, not events
        return ExamSetup(world, self.seed, events=events, saved=saved, autonomous_values=alone, stuck_ends=stuck_ends)

    async def _drive(self, exams: Sequence[ExamSetup], report: Report, engine: Engine) -> list[DriveRow]:
        return await run_drives(self.factory, self.robot, self.task, exams, report, engine)


@dataclass(frozen=True, slots=True, kw_only=True)
class FirstPhasesJob(PhasesJob):
    """Training run of phases 1 and 2, with exams before it, of the knowledge of phase 1, and of all knowledge."""

    gives_lesson: ClassVar[bool] = True

    async def measure(self, knowledge: Path, report: Report) -> JobOutcome:
        """Teach phases 1 and 2 into the file `knowledge`, examine all stages and return the outcome."""
        lesson, events = await self.teach(knowledge, report)
        teachers = await self.drive_teacher(report)
        answered = list(takewhile(lambda event: event.origin.phase is Phase.SUPERVISED, events))
        stages = [
            _stage_outcome(
                name,
                _system_of(self.task, self.robot, known),
                _teaching_outcome(lesson, events) if name == Step.PHASE_2 else None,
                await self.examine(self.exam_of(known), teachers, report),
            )
            for name, known in ((Step.UNTAUGHT, []), (Step.PHASE_1, answered), (Step.PHASE_2, events))
        ]
        return JobOutcome(made_of=self.made_of, seed=self.seed, stages=tuple(stages), teachers=teachers)


@dataclass(frozen=True, slots=True, kw_only=True)
class StepJob(PhasesJob):
    """Job that continues the knowledge of an earlier job of its robot by one step of phases 3 to 5."""

    of: PhaseStep
    before: "FirstPhasesJob | StepJob"
    """Job whose knowledge this one continues."""
    first: FirstPhasesJob
    """Job with the teacher's own drives."""
    alike: "FirstPhasesJob | StepJob | None"
    """Job with the number of penalties for random ones."""

    async def measure(self, knowledge: Path, report: Report) -> JobOutcome:
        """Prepare the knowledge in the file `knowledge`, teach the step, examine it and return the outcome.

        Raises StudyError without the result of an earlier step, and the errors of all jobs.
        """
        step = self.of
        self._copy_knowledge(knowledge)
        self._prepare(knowledge)
        before = len(read_lessons(knowledge, self.robot, self.task))
        teaching, autonomous_values, plan = None, None, self.plan()
        if plan is not None:
            lesson, events = await self.teach(knowledge, report, plan=plan)
            teaching, autonomous_values = _teaching_outcome(lesson, events[before:]), lesson.autonomous_values
            if step.aside:
                self._copy_knowledge(knowledge)
                self._add(knowledge, list(critic_lessons(events[before:])))
        with Journal.read_only(knowledge) as journal:
            events, saved = [entry.event for entry in journal.entries()], journal.statistics()
            system = fold_journal(journal, radius=self.task.learning.radius)
        if step.aside:  # the basic level is unchanged, and its exams are, too
            exams = self.results.read(self.before, JobOutcome).stages[-1].exams
        else:
            by_world = {each.world: each for each in self.results.read(self.first, JobOutcome).teachers}
            teachers = [by_world[world] for world in step.worlds]
            exams = await self.examine(self.exam_of(events, saved, autonomous_values), teachers, report)
        judgements = await self.judge_critic(self.exam_of(events, saved), report) if step.judges_critic else ()
        stage = _stage_outcome(step.name, system, teaching, exams, judgements)
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
        return replace(plan, blame_by_chance=stage.teaching.negative_rewards)

    def _copy_knowledge(self, knowledge: Path) -> None:
        """Copy the knowledge that the step continues."""
        shutil.copyfile(self._left_by(self.of.after), knowledge)

    def _left_by(self, step: Step) -> Path:
        """Return the knowledge file of another step. Raises StudyError without the file."""
        stem, folder = f"{step}/{self.task.name}-{self.seed}", self.results.folder
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
        taught = self._left_by(Step.PHASE_4)
        if self.of.critic == "taught":
            yield from critic_lessons(read_lessons(taught, self.robot, self.task))
            return
        with Journal.read_only(taught) as journal:
            appraisals = fold_journal(journal, radius=1.0).rlas_at(CRITIC)
        yield from shuffled(appraisals, load_critic(self.task.critic), self.seed, self.robot.cycle_s)


class PhasesTask(NamedTuple):
    """Subject of the phases study: a task, and whether only a quick part is done."""

    task: TaskSettings
    quick: bool
    """A part only."""


def make_plan(
    task: TaskSettings,
    seeds: Sequence[int],
    parts: JobParts,
    *,
    quick: bool = False,
    engine: EngineRequest = EngineRequest.CAN,
) -> StudyPlan[PhasesTask]:
    """Check task and worlds, and return the jobs, all steps for each seed.

    Lessons of phases 3 to 5 are given on the CAN bus. `quick`: each step so short that it only shows that it works.
    Raises config.settings.SettingsError if the task has no section on phases, or does not fit a world.
    """
    robot = parts["robot"]
    if quick:
        task = shortened(task, robot)
    worlds = (task.teaching.world, *task.exam.worlds, *phases_of(task).repair_worlds)
    require_places(parts["factory"], task, worlds)
    # What is long enough for one step decides nothing of another: each is made of the steps that lead to it.
    fingerprints = Fingerprints(parts["factory"], robot)
    critic = critic_of(task.critic, robot).model_dump_json()
    steps = {step.name: step for step in steps_of(task)}

    def made_of(step: PhaseStep | None) -> Provenance:
        return fingerprints.of(task, worlds, critic, "\n".join(map(repr, _way_to(step, steps))))

    made, exam_s = {name: made_of(step) for name, step in steps.items()}, task.exam.duration_s
    jobs: list[PhasesJob] = []
    for seed in seeds:
        first = FirstPhasesJob(
            **parts,
            task=task,
            seed=seed,
            made_of=made_of(None),
            name=f"phases 1 and 2, seed {seed}",
            stem=f"{Step.PHASE_2}/{task.name}-{seed}",
            robot_time_s=task.teaching.duration_s + 3 * len(task.exam.worlds) * exam_s,
        )
        of_robot: dict[Step, FirstPhasesJob | StepJob] = {Step.PHASE_2: first}
        for name, step in steps.items():
            drives = 0 if step.aside else len(step.worlds) + step.judges_critic
            of_robot[name] = StepJob(
                **parts,
                task=task,
                seed=seed,
                made_of=made[name],
                name=f"{name.label}, seed {seed}",
                stem=f"{name}/{task.name}-{seed}",
                robot_time_s=(step.plan.duration_s if step.plan else 0.0) + drives * exam_s,
                wave=_depth(step, steps),
                of=step,
                before=of_robot[step.after],
                first=first,
                alike=of_robot[step.blames_like] if step.blames_like else None,
            )
        jobs += of_robot.values()
    return StudyPlan(PhasesTask(task, quick), tuple(seeds), tuple(jobs)).driven(engine, robot)


def _way_to(step: PhaseStep | None, by_name: dict[Step, PhaseStep]) -> Iterator[PhaseStep]:
    """Yield all steps that lead to a step, and the step itself."""
    if step is not None:
        for name in step.needs:
            yield from _way_to(by_name.get(name), by_name)
        yield step


def _depth(step: PhaseStep, by_name: dict[Step, PhaseStep]) -> int:
    return 1 + max(0 if name == Step.PHASE_2 else _depth(by_name[name], by_name) for name in step.needs)
