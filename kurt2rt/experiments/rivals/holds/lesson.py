"""Lesson with a teacher in charge: it drives by held actions, and the learner is fitted at intervals."""

import random
import time
from collections import deque
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

from hal.simulation import Simulation
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.event_store import InMemoryEventStore
from kurt2rt.core.learner.learner import Label, Why
from kurt2rt.core.learner.learner_team import LearnerTeam
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.programs import SCRIPTED
from kurt2rt.core.teaching.commands import HoldAction
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.experiments.lockstep.lesson import TrainingResult
from kurt2rt.experiments.lockstep.lesson_plan import LessonPlan, plan_of
from kurt2rt.experiments.lockstep.runtimes import TrainingStore, build_training_runtime
from kurt2rt.experiments.rivals.holds.hold_learner import HoldLearner
from kurt2rt.experiments.rivals.holds.pupil import LearnerPupil, RlaPupil
from kurt2rt.experiments.rivals.learner_clock import LearnerClock, untimed
from kurt2rt.experiments.rivals.lesson import MarkedRun, OnProgress, RivalLesson, RivalSetup, session_of
from kurt2rt.runtime import Runtime
from kurt2rt.teacher.scripted.build import build_teacher_in_charge
from kurt2rt.teacher.scripted.teacher_in_charge import Charge

_SAMPLE_TICKS = 10
"""Ticks between two samples of a drive, as between two lessons of a hold."""


@dataclass(frozen=True, slots=True)
class FitTimes:
    """Times of the fits of a learner, on the robot's clock."""

    first_s: float = 30.0
    """Time that the teacher drives before the first fit."""
    every_s: float = 30.0
    """Time between two fits."""
    takes_s: float = 2.0
    """Time that the robot stands while it is fitted, whatever the machine takes."""
    overruled_s: float = 1.5
    """Time before a take-over in which the robot's own actions count as overruled: notice, reaction and link."""


TIMES = FitTimes()


class _Own(NamedTuple):
    """Action of a robot by itself, which its teacher may still overrule."""

    tick: int
    label: Label


async def teach_by_holds(
    simulation: Simulation, setup: RivalSetup, clock: LearnerClock, on_progress: OnProgress, times: FitTimes = TIMES
) -> RivalLesson:
    """Give a lesson as long as the task's, with a teacher in charge.

    Args:
        simulation: that the robot drives in.
        setup: of robot and teacher; its seed also draws DAgger's mixing.
        clock: gets the processor time of the fits.
        on_progress: gets the simulated seconds.
        times: of the fits.

    Raises:
        LessonLostError: the robot refused a command.
        hal.settings.SettingsError: task and world do not fit.
    """
    store, team = InMemoryEventStore(), setup.team
    training = TrainingStore(store, learners=team)
    runtime = build_training_runtime(simulation, setup.robot, setup.task, training)
    learners = {} if team is None else _hold_learners(team, setup.task.behaviours)
    run = _HoldRun(simulation, runtime, store, setup, learners, clock, on_progress=on_progress, times=times)
    await run.drive()
    return run.lesson()


def _hold_learners(team: LearnerTeam, behaviours: Sequence[str]) -> dict[str, HoldLearner]:
    """Return the learners of a team by their behaviours."""
    learners = {behaviour: untimed(team.learner(behaviour)) for behaviour in behaviours}
    assert all(isinstance(each, HoldLearner) for each in learners.values())
    return {behaviour: each for behaviour, each in learners.items() if isinstance(each, HoldLearner)}


class _HoldRun(MarkedRun):
    """Training run by a teacher in charge."""

    def __init__(
        self,
        simulation: Simulation,
        runtime: Runtime,
        store: InMemoryEventStore,
        setup: RivalSetup,
        learners: Mapping[str, HoldLearner],
        clock: LearnerClock,
        *,
        on_progress: OnProgress,
        times: FitTimes,
    ) -> None:
        task, period_s = runtime.task, runtime.robot.cycle_s
        self._team, self._learners, self._clock = setup.team, dict(learners), clock
        for learner in self._learners.values():
            learner.fits_at_intervals = True
        self._lessons = LearnerPupil(self._learners, round(times.first_s / period_s)) if learners else None
        self._pupil = self._lessons or RlaPupil()
        # A teacher in charge corrects from the first moment, so there is a single phase.
        plan = LessonPlan(((Phase.CORRECTIONS, plan_of(task).duration_s),))
        self._in_charge = build_teacher_in_charge(
            task,
            runtime.robot,
            tuple(runtime.level.repertoire),
            self._pupil.charge,
            seed=setup.seed,
            session=session_of(plan, setup.seed),
        )
        super().__init__(
            simulation, runtime, store, setup, on_progress=on_progress, plan=plan, answering=self._in_charge
        )
        self._every, self._takes, self._overruled = (
            round(each / period_s) for each in (times.every_s, times.takes_s, times.overruled_s)
        )
        self._chance = random.Random(f"mixing of {session_of(plan, setup.seed)}")
        self._named: deque[tuple[int, Label]] = deque(maxlen=200)
        self._own: deque[_Own] = deque()
        self._was_in_charge = self._was_named = self._by_teacher = False
        self._fitted_at = self._stands_until = self._labels_fitted = 0
        self._troubles = self._asked = self._in_charge_ticks = self._asking_ticks = 0

    def on_tick(self, record: TickRecord) -> None:
        """Let the teacher react to what the robot does and offers; then sample, and fit the learners if it is time."""
        self._in_charge.offer = self._pupil.offer(record, self._in_charge.hand)
        super().on_tick(record)
        stands = record.tick <= self._stands_until
        asking = record.decision.asking and not stands
        self._asked += self.question.begins and not stands
        self._asking_ticks += asking
        if record.tick == self._stands_until:  # if it asks after the fit, that is a question
            self.question.close()
        names = self._pupil.charge is Charge.NAMES
        driven = self._in_charge.hand is not None if names else record.decision.cause is DecisionCause.TEACHER
        self._in_charge_ticks += driven
        if self._lessons is None:
            return
        self._lessons.driven_ticks[record.behaviour] += driven
        if names:
            self._mix(record)
        self._sample_own(record, driven=driven)
        self._note_trouble()
        self._fit_if_due(record.tick, driven=driven and not names)

    def result(self) -> TrainingResult:
        """Return the counters; a robot that stands to be fitted does not ask."""
        return replace(super().result(), asks=self._asked)

    def lesson(self) -> RivalLesson:
        """Return the result with the marks; the teacher is charged for all time in which its hand is on the robot."""
        for own in self._own:
            self._keep(own.label)
        self._own.clear()
        driven_s, waited_s = self._in_charge_ticks * self.period_s, self._asking_ticks * self.period_s
        return replace(super().lesson(), driven_s=driven_s, waited_s=waited_s)

    def _mix(self, record: TickRecord) -> None:
        """Label the situation that the teacher's hand reacted to, and draw whose action drives next."""
        hand = self._in_charge.hand
        if hand is not None and not self._was_named:
            self._was_named = True
            self._workload.count(record.tick, HoldAction(SCRIPTED, record.tick, 1, hand))
        due = record.tick % _SAMPLE_TICKS == 0
        if due:
            self._by_teacher = self._learners[record.behaviour].drives_by_teacher(self._chance.random())
            self._named.append((record.tick, self._label_of(record, hand or "", Why.HOLD)))
        for learner in self._learners.values():
            learner.advised = hand if self._by_teacher else None
        if not due or hand is None:
            return
        handler = self.runtime.handler
        reacted = self._in_charge.hand_saw_tick - handler.delay.hand_ticks(SCRIPTED, handler.authority.speed)
        meant = next((label for tick, label in reversed(self._named) if tick <= reacted), None)
        if meant is not None:
            self._keep(meant._replace(action=hand, command_id=f"named-{record.tick}"))

    def _sample_own(self, record: TickRecord, *, driven: bool) -> None:
        """Keep what the robot does by itself, once its teacher has let it pass or overruled it."""
        learner = self._learners[record.behaviour]
        if driven and not self._was_in_charge:
            overruled = self._pupil.charge is Charge.BY_TEACHER
            self._flush(Why.OVERRULED if overruled else Why.DROVE)
            learner.on_takeover(record.situation.vector)
        self._was_in_charge = driven
        if not learner.takes_own_samples:
            return
        if self._own and self._own[0].tick <= record.tick - self._overruled:
            self._keep(self._own.popleft().label)
        decision = record.decision
        if decision.cause is DecisionCause.LEARNER and decision.action and record.tick % _SAMPLE_TICKS == 0:
            self._own.append(_Own(record.tick, self._label_of(record, decision.action, Why.DROVE)))

    def _note_trouble(self) -> None:
        troubles = self.simulation.collisions + self._alarms + self._rescues
        if troubles == self._troubles:
            return
        self._troubles = troubles
        self._flush(Why.DROVE)
        for learner in self._learners.values():
            learner.on_trouble()

    def _flush(self, why: Why) -> None:
        for own in self._own:
            self._keep(own.label._replace(why=why))
        self._own.clear()

    def _fit_if_due(self, tick: int, *, driven: bool) -> None:
        """Fit all learners and let the robot stand meanwhile; never while its teacher drives it."""
        if tick == self._stands_until:
            self._set_standing(stands=False)
        assert self._team is not None
        assert self._lessons is not None
        fitted = any(learner.iteration for learner in self._learners.values())
        due = (fitted and tick - self._fitted_at >= self._every) or self._lessons.awaits_first_fit
        if driven or tick <= self._stands_until or not due or len(self._team.labels) == self._labels_fitted:
            return
        began_ns = time.thread_time_ns()
        for learner in self._learners.values():
            learner.refit()
        self._clock.retraining_ns += time.thread_time_ns() - began_ns
        self._labels_fitted, self._fitted_at = len(self._team.labels), tick
        self._stands_until = tick + self._takes
        self._set_standing(stands=True)

    def _set_standing(self, *, stands: bool) -> None:
        for learner in self._learners.values():
            learner.stands = stands

    def _keep(self, label: Label) -> None:
        assert self._team is not None
        self._team.teach(label)

    def _label_of(self, record: TickRecord, action: str, why: Why) -> Label:
        situation = record.situation.vector.copy()
        situation.flags.writeable = False
        return Label(situation, record.behaviour, action, why, f"own-{record.tick}")
