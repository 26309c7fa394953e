"""Scripted teacher of a story: answers, corrects, praises, errs, stops, takes lessons back, goes away."""

import random

from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.task_settings import TaskSettings, TeacherSettings
from kurt2rt.core.teacher_settings import QUICK_TEACHER
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    Correct,
    HoldAction,
    Resume,
    Reward,
    SetPhase,
    Stop,
    Take,
    Undo,
    Watch,
)
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.task_repertoire import load_task_repertoire
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.build import build_teacher
from tests.stories.device import TEACHER
from tests.stories.program import Program
from tests.stories.story import Teaching

_AWAY_EVERY_S, _AWAY_S = 30.0, 4.0
_MOST_CORRECTIONS = 100
_RESUMES_EVERY_S = 1.0
_STOPS_EVERY_S, _UNDOES_EVERY_S, _SIGNALS_EVERY_S = 45.0, 180.0, 20.0
_REGRETS = 0.2
"""Share of resumes after which he says stop at once, which may overtake the resume on the way."""
_TAKES_EVERY_S, _STOPS_ANOTHER_EVERY_S = 2.0, 3.0
"""Times in which he takes the robot back from another teacher, and tells it to stop."""
_PRESSES_AGAIN_EVERY_S = 0.5
"""Time in which the other one lets go and presses again."""
_WATCHES_EVERY_S = 0.1
_HOLDS_S = 1.0


class StoryTeacher:
    """Teacher of one start of the program."""

    def __init__(self, program: Program, task: TaskSettings, teaching: Teaching, chance: random.Random) -> None:
        self.is_calm = False
        """True when he is there, and neither errs nor stops any more."""
        self._program, self._chance = program, chance
        robot = program.robot
        self._cycle_s = robot.cycle_s
        self._phase = Phase(teaching.phase)
        profile = QUICK_TEACHER.model_copy(
            update={"answers_by": teaching.by, "corrects_by": teaching.by, "hold_s": _HOLDS_S}
        )
        teacher = TeacherSettings(reaction_s=teaching.reaction_s, patience_s=0.3, error_rate=teaching.error_rate)
        lessons = task.teaching.model_copy(update={"teacher": teacher, "profile": profile})
        self._scripted = build_teacher(
            task.model_copy(update={"teaching": lessons}),
            robot,
            tuple(load_task_repertoire(task, robot)),
            seed=chance.getrandbits(32),
            session=program.next_id(),
        )
        self._scripted.phase = self._phase
        self._appraisals = tuple(load_critic(task.critic).values)
        self._corrections = self._stopped_ticks = 0
        self._away_until_tick = 0

    def update(self, record: TickRecord) -> list[Command]:
        """Return what he says after this tick."""
        if self._happens(_AWAY_EVERY_S):
            self._away_until_tick = record.tick + round(_AWAY_S / self._cycle_s)
        if not self.is_calm and record.tick < self._away_until_tick:
            return []
        watch: list[Command] = [Watch(TEACHER, record.tick)] if self._is_due(record.tick, _WATCHES_EVERY_S) else []
        return watch + self._commands(record)

    def _commands(self, record: TickRecord) -> list[Command]:
        chance = self._chance
        if self._program.runtime.handler.authority.teacher not in (None, TEACHER):
            if self._happens(_PRESSES_AGAIN_EVERY_S):
                self._program.hand.press_again()
            if self._happens(_STOPS_ANOTHER_EVERY_S):
                return [Stop("", TEACHER)]
            return [Take("", TEACHER)] if self._is_due(record.tick, _TAKES_EVERY_S) else []
        if record.number == 1:
            return [BeginSession("", TEACHER, self._program.next_id()), SetPhase("", TEACHER, self._phase)]
        if record.guard_result.latched or record.decision.cause is DecisionCause.STOPPED:
            self._stopped_ticks += 1
            if not self._is_due(self._stopped_ticks, _RESUMES_EVERY_S):
                held = self._scripted.update(view_of_tick(record))
                return [held] if isinstance(held, HoldAction) else []
            regrets = not self.is_calm and chance.random() < _REGRETS
            return [Resume("", TEACHER, record.tick), *([Stop("", TEACHER)] if regrets else [])]
        self._stopped_ticks = 0
        if self._happens(_STOPS_EVERY_S):
            return [Stop("", TEACHER)]
        if self._happens(_UNDOES_EVERY_S):
            return [Undo("", TEACHER)]
        if self._phase == Phase(3) and record.decision.driving and self._happens(_SIGNALS_EVERY_S):
            return [Reward("", TEACHER, chance.choice((1, 1, -1)), record.tick)]
        if self._phase == Phase(4) and self._happens(_SIGNALS_EVERY_S):
            return [Appraise("", TEACHER, chance.choice(self._appraisals), record.tick)]
        view = view_of_tick(record)
        if not view.asking and self._corrections >= _MOST_CORRECTIONS:
            return []  # he looks on
        command = self._scripted.update(view)
        self._corrections += isinstance(command, Correct)
        return [] if command is None else [command]

    def _is_due(self, tick: int, period_s: float) -> bool:
        return tick % round(period_s / self._cycle_s) == 0

    def _happens(self, every_s: float) -> bool:
        return not self.is_calm and self._chance.random() < self._cycle_s / every_s
