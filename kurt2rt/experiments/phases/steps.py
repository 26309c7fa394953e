"""Steps of one robot's training: the path of all phases, and the branches with their wrong actions and critics."""

import random
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Literal, Self, TypeVar

from config.settings import Settings, SettingsError
from hal.robot_settings import RobotSettings
from kurt2rt.core.critic.settings import CriticSettings, critic_of
from kurt2rt.core.phase_settings import PhasesSettings
from kurt2rt.core.rla.events import ActionReplaced, Appraised, RlaCreated, RlaDeleted, TeachingEvent
from kurt2rt.core.rla.rla import CRITIC, Origin, Phase, Rla
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, SignalTimes, Signs
from kurt2rt.experiments.study.jobs import shortened_task

Critic = Literal["own", "taught", "shuffled"]
"""Critic before the step: the knowledge's own, the one of this robot's phase 4, or a shuffled one."""


class Step(StrEnum):
    """Step of one robot's training, as files name it, with its title in tables."""

    label: str

    def __new__(cls, value: str, label: str) -> Self:
        """Return a step; `label`: its title."""
        step = str.__new__(cls, value)
        step._value_, step.label = value, label
        return step

    UNTAUGHT = "untaught", "untaught"
    PHASE_1 = "phase-1", "phase 1, answers"
    PHASE_2 = "phase-2", "phase 2, corrections"
    PHASE_3 = "phase-3", "phase 3, rewards"
    PHASE_4 = "phase-4", "phase 4, critic taught"
    PHASE_5 = "phase-5", "phase 5, autonomous"
    LONG_RUN = "long-run", "long run"
    CORRUPTED = "corrupted", "corrupted, untouched"
    ASKS = "asks-only", "asks only"
    UNKNOWN_BAD = "unknown-is-bad", "asks, unknown is -1"
    BLAME_BY_CHANCE = "blame-by-chance", "asks, -1 by chance"
    REWARDS = "rewards", "asks and rewards (phase 3)"
    JUDGED = "critic-judged", "critic judged"
    CRITIC_ALONE = "critic-alone", "critic alone (phase 5)"
    SHUFFLED = "critic-shuffled", "shuffled critic alone"
    INTACT = "intact-autonomous", "intact set, critic alone"


SettingsT = TypeVar("SettingsT", bound=Settings)
_QUICK_TEACHING_S, _QUICK_EXAM_S, _QUICK_STEP_S, _QUICK_ALONE_S = 40.0, 6.0, 10.0, 40.0
_QUICK_SHARE = 0.2
"""Factor of the intervals in a quick run."""

PATH = (Step.UNTAUGHT, Step.PHASE_1, Step.PHASE_2, Step.PHASE_3, Step.PHASE_4, Step.PHASE_5)
BRANCHES = (
    Step.CORRUPTED,
    Step.ASKS,
    Step.UNKNOWN_BAD,
    Step.BLAME_BY_CHANCE,
    Step.REWARDS,
    Step.CRITIC_ALONE,
    Step.SHUFFLED,
)


@dataclass(frozen=True, slots=True)
class PhaseStep:
    """Plan of one step: the knowledge it continues, what is done to that, and the worlds of its exams."""

    name: Step
    after: Step
    """The step that it goes on from."""
    corrupted: float
    """Share of its RLAs that get another action first."""
    critic: Critic
    plan: LessonPlan | None
    """None: nothing is taught."""
    worlds: tuple[str, ...]
    """Worlds of the exams."""
    mistakes: str = "repair"
    """Purpose of the wrong actions, which chooses them."""
    blames_like: Step | None = None
    """Step with the number of penalties for random ones; None without random penalties."""
    judges_critic: bool = False
    """True if a drive without learning compares critic and judge."""
    aside: bool = False
    """True if only the critic is kept of the step, and knowledge and exams are those before it."""

    @property
    def needs(self) -> tuple[Step, ...]:
        """Names of the steps that have to be done before this step."""
        critic = () if self.critic == "own" else (Step.PHASE_4,)
        return (self.after, *critic, *([self.blames_like] if self.blames_like else []))


def phases_of(task: TaskSettings) -> PhasesSettings:
    """Return the section of the task on phases 3 to 5. Raises config.settings.SettingsError without one."""
    if task.phases is None:
        raise SettingsError(
            "says nothing about phases 3 to 5", where=f"task {task.name}", do="add a section `phases:` to its file"
        )
    if task.judge is None:
        raise SettingsError(
            "there is no judge, so the teacher cannot reward", where=f"task {task.name}", do="add `judge:`"
        )
    return task.phases


@dataclass(frozen=True, slots=True)
class _Plans:
    """Lesson plans of one task's steps. Robots that are compared are rescued by one rule in all phases."""

    task: TaskSettings
    phases: PhasesSettings

    def asking(self) -> LessonPlan:
        """Return the plan of a teacher who answers only."""
        times, moved_s = ((Phase.SUPERVISED, self.phases.repair_s),), self.phases.reposition_every_s
        return LessonPlan(times, "repair", rescues_who_asks=True, reposition_every_s=moved_s)

    def rewards(self, lasts_s: float, purpose: str, signs: Signs) -> LessonPlan:
        """Return the plan of a teacher who answers and rewards, for `lasts_s` seconds."""
        told, moved_s = self.phases.signals, self.phases.reposition_every_s
        times = SignalTimes(told.bad_every_s, told.good_every_s, patience_s=told.patience_s, most_blame=told.most_blame)
        phases = ((Phase.REINFORCEMENT, lasts_s),)
        return LessonPlan(phases, purpose, signs, times, rescues_who_asks=True, reposition_every_s=moved_s)

    def appraisals(self) -> LessonPlan:
        """Return the plan of a teacher who teaches the critic."""
        phases, times = self.phases, self.phases.appraisals
        return LessonPlan(
            ((Phase.CRITIC, phases.critic_s),),
            "phase 4",
            "judge",
            SignalTimes(times.bad_every_s, times.good_every_s, times.neutral_every_s, gap_s=times.gap_s),
            rescues_who_asks=True,
            set_down_every_s=phases.set_down_every_s,
            shown_s=phases.shown_s,
            shown_share=phases.shown_share,
        )

    def autonomous(self, lasts_s: float, purpose: str) -> LessonPlan:
        """Return the plan without a teacher, for `lasts_s` seconds: rescues come later, none is planned."""
        phases, stuck_s = ((Phase.AUTONOMOUS, lasts_s),), self.task.exam.stuck_after_s
        return LessonPlan(phases, purpose, rescues_who_asks=True, rescue_after_s=stuck_s, reposition_every_s=0.0)


def steps_of(task: TaskSettings) -> Iterator[PhaseStep]:
    """Yield all steps after the lesson of phases 1 and 2, each after those it needs.

    Raises config.settings.SettingsError if the task has no section on phases.
    """
    plans = _Plans(task, phases_of(task))
    yield from _path_steps(plans)
    yield from _branch_steps(plans)


def _path_steps(plans: _Plans) -> Iterator[PhaseStep]:
    phases, worlds = plans.phases, plans.task.exam.worlds
    rewards = plans.rewards(phases.reinforcement_s, "phase 3", "judge")
    yield PhaseStep(Step.PHASE_3, Step.PHASE_2, 0.0, "own", rewards, phases.repair_worlds)
    critic, wrong = plans.appraisals(), phases.corrupted_share
    yield PhaseStep(
        Step.PHASE_4, Step.PHASE_3, wrong, "own", critic, phases.repair_worlds, mistakes="critic", aside=True
    )
    yield PhaseStep(Step.PHASE_5, Step.PHASE_4, 0.0, "own", plans.autonomous(phases.autonomy_s, "phase 5"), worlds)
    yield PhaseStep(Step.LONG_RUN, Step.PHASE_5, 0.0, "own", plans.autonomous(phases.long_run_s, "long run"), ())


def _branch_steps(plans: _Plans) -> Iterator[PhaseStep]:
    phases = plans.phases
    worlds, wrong = phases.repair_worlds, phases.corrupted_share
    judge = plans.rewards(phases.repair_s, "repair", "judge")
    chance = plans.rewards(phases.repair_s, "repair", "chance")
    unknown = plans.rewards(phases.repair_s, "repair", "unknown")
    alone = plans.autonomous(phases.repair_alone_s, "repair")
    yield PhaseStep(Step.CORRUPTED, Step.PHASE_2, wrong, "own", None, worlds)
    yield PhaseStep(Step.ASKS, Step.PHASE_2, wrong, "own", plans.asking(), worlds)
    yield PhaseStep(Step.UNKNOWN_BAD, Step.PHASE_2, wrong, "own", unknown, worlds)
    yield PhaseStep(Step.REWARDS, Step.PHASE_2, wrong, "own", judge, worlds)
    yield PhaseStep(Step.BLAME_BY_CHANCE, Step.PHASE_2, wrong, "own", chance, worlds, blames_like=Step.REWARDS)
    yield PhaseStep(Step.JUDGED, Step.PHASE_2, wrong, "taught", None, (), judges_critic=True)
    yield PhaseStep(Step.CRITIC_ALONE, Step.PHASE_2, wrong, "taught", alone, worlds)
    yield PhaseStep(Step.SHUFFLED, Step.PHASE_2, wrong, "shuffled", alone, worlds)
    yield PhaseStep(Step.INTACT, Step.PHASE_2, 0.0, "taught", alone, plans.task.exam.worlds)


def shortened(task: TaskSettings, robot: RobotSettings) -> TaskSettings:
    """Return the task with all steps so short that they say nothing but that everything works.

    A few rewards can withdraw a value, and the critic is trusted, measures and changes after some seconds.
    """

    def hastened(part: SettingsT, *names: str) -> SettingsT:
        return part.model_copy(update={name: _QUICK_SHARE * getattr(part, name) for name in names})

    critic, worlds = critic_of(task.critic, robot), task.exam.worlds[:1]
    few = max(2, round(_QUICK_SHARE * critic.agreement.least))
    agreement = hastened(critic.agreement, "bound", "apart_s").model_copy(update={"least": few, "window": 2 * few})
    hasty = {
        "agreement": agreement,
        "signal_every_s": hastened(critic.signal_every_s, "bad", "good"),
        "need": critic.need.model_copy(update={"bad_share": 0.0, "first_s": 0.0}),
        "best": critic.best.model_copy(update={"window_s": _QUICK_ALONE_S / 8}),
    }
    alone = hastened(task.reinforcement.alone, "first_value", "sunk_below", "well_above")
    phases = phases_of(task).shortened(_QUICK_STEP_S, worlds, _QUICK_ALONE_S, _QUICK_SHARE)
    exam = task.exam.model_copy(update={"worlds": worlds})
    short = shortened_task(task.model_copy(update={"exam": exam}), _QUICK_TEACHING_S, _QUICK_EXAM_S)
    return short.model_copy(
        update={
            "phases": phases,
            "critic": critic.model_copy(update=hasty),
            "reinforcement": task.reinforcement.model_copy(update={"alone": alone}),
        }
    )


_NAME = "corruption"


def corrupt(
    rlas: Sequence[Rla], actions: Sequence[str], share: float, seed: int, purpose: str
) -> Iterator[ActionReplaced]:
    """Yield the corrections that make a share of the RLAs wrong, for a step that has to repair them.

    `share`: 0 to 1, but at least one RLA. The wrong actions are drawn from `actions`. Each purpose has wrong actions of
    its own: a critic is not examined on those that it was taught on.
    """
    chance = random.Random(f"corruption for {purpose}, seed {seed}")
    chosen = chance.sample(rlas, max(1, round(share * len(rlas)))) if rlas else []
    for number, rla in enumerate(chosen, start=1):
        action = chance.choice([each for each in actions if each != rla.action])
        origin = Origin(f"corruption-{purpose}-{seed}-{number}", _NAME, Phase.CORRECTIONS, rla.origin.tick)
        yield ActionReplaced(rla.rla_id, action, rla.action, origin)


def critic_lessons(events: Iterable[TeachingEvent]) -> Iterator[TeachingEvent]:
    """Yield the events that taught the critic, to give the same critic to other knowledge of the robot."""
    ids: set[int] = set()
    for event in events:
        match event:
            case RlaCreated(rla) if rla.level == CRITIC:
                ids.add(rla.rla_id)
                yield event
            case Appraised():
                yield event
            case ActionReplaced(rla_id) | RlaDeleted(rla_id) if rla_id in ids:
                yield event


def shuffled(
    appraisals: Sequence[Rla], settings: CriticSettings, seed: int, period_s: float
) -> Iterator[TeachingEvent]:
    """Yield the lessons of a control critic: appraisal RLAs with shuffled opinions, and appraisals to trust them.

    `seed`: of the shuffle. `period_s`: duration of a tick in s.
    """
    opinions = [rla.action for rla in appraisals]
    random.Random(f"shuffled critic, seed {seed}").shuffle(opinions)
    for rla, opinion in zip(appraisals, opinions, strict=True):
        origin = Origin(f"shuffled-{seed}-{rla.rla_id}", _NAME, Phase.CRITIC, rla.origin.tick)
        yield RlaCreated(
            Rla(rla.rla_id, rla.condition, opinion, rla.radius, origin, behaviour=rla.behaviour, level=rla.level)
        )
    apart_ticks = round(settings.agreement.apart_s / period_s)
    tick = max((rla.origin.tick for rla in appraisals), default=0)
    for appraisal in settings.appraisals:
        for number in range(settings.agreement.window):
            tick += apart_ticks
            origin = Origin(f"trusted-{seed}-{appraisal.name}-{number}", _NAME, Phase.CRITIC, tick)
            yield Appraised(appraisal.name, appraisal.value, tick, origin)


class Judgement(Settings):
    """Number of ticks in which judge and critic had this pair of opinions."""

    judged: int
    """Opinion of the judge: -1, 0 or +1."""
    said: int | None
    """Opinion of the critic; None: unknown."""
    ticks: int
