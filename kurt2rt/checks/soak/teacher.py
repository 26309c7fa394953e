"""Scripted teacher of changing moods."""

import random

from hal.robot_settings import RobotSettings
from kurt2rt.checks.soak.settings import MoodSettings, SoakSettings
from kurt2rt.core.critic.settings import load_critic
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.task_settings import TaskSettings, TeacherSettings
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeginSession,
    Command,
    Correct,
    Resume,
    Reward,
    SetPhase,
    Stop,
    Take,
    Undo,
    Watch,
)
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.teacher.scripted.basic_teacher import view_of_tick
from kurt2rt.teacher.scripted.teacher import ScriptedTeacher

NAME = "scripted teacher"
_SIGN_EVERY_TICKS = 2
_TAKES_EVERY_TICKS = 20
_STOPS_FOR_S = (0.3, 3.0)
_LEAST_REACTION_S = 0.3
_MARGIN = 0.7
"""Probability of a positive reward."""


class SoakTeacher:
    """Teacher who changes moods, outlives the program and resumes it after each start."""

    def __init__(
        self, soak: SoakSettings, task: TaskSettings, robot: RobotSettings, actions: tuple[str, ...], seed: int
    ) -> None:
        self.mood = ""
        """Present mood; empty before the first tick."""
        self.sent = 0
        """Commands so far, without signs of presence."""
        self._soak, self._task, self._robot, self._actions = soak, task, robot, actions
        self._period_s = robot.cycle_s
        self._chance = random.Random(f"teacher of {soak.name}, seed {seed}")
        self._appraisals = tuple(load_critic(task.critic).values)
        self._moods = 0
        self._mood_left = 0
        self._settings: MoodSettings
        self._scripted: ScriptedTeacher
        self._begins: list[Command] = []
        self._corrected = 0
        self._most_corrections = soak.first_corrections
        self._stopped_ticks = 0
        self._resumes_in = 0
        self._started_anew = True

    def program_started(self) -> None:
        """Reset what a restarted program has lost: session, phase and teacher."""
        self._started_anew = True

    def watch(self, record: TickRecord, *, hand: bool, taken: bool) -> list[Command]:
        """Return the commands after a tick, in order; call it after each tick.

        `hand`: another teacher drives manually. `taken`: that teacher still has control.
        """
        if self._mood_left == 0:
            self._change_mood()
        self._mood_left -= 1
        settings = self._settings
        if not settings.there or hand:
            return []
        said: list[Command] = []
        if record.tick % _SIGN_EVERY_TICKS == 0:
            said.append(Watch(NAME, record.tick))
        commands = self._take_back(record) if taken else self._commands(record)
        return said + commands

    def stop(self) -> Command:
        """Return the command to stop."""
        return Stop(self._next_id(), NAME)

    def _commands(self, record: TickRecord) -> list[Command]:
        settings, chance = self._settings, self._chance
        if self._started_anew:
            self._started_anew = False
            self._stopped_ticks = 0
            identity = self._next_id()
            return [
                BeginSession(identity, NAME, identity),
                SetPhase(self._next_id(), NAME, Phase(settings.phase)),
            ]
        if self._begins:
            begins, self._begins = self._begins, []
            return begins
        if record.guard_result.latched or record.decision.cause is DecisionCause.STOPPED:
            return self._resume(record)
        self._stopped_ticks = 0
        if self._happens(settings.stops_every_s):
            self._resumes_in = round(chance.uniform(*_STOPS_FOR_S) / self._period_s)
            return [self.stop()]
        if self._happens(settings.undoes_every_s):
            return [Undo(self._next_id(), NAME)]
        if self._happens(settings.rewards_every_s) and record.decision.driving:
            return [Reward(self._next_id(), NAME, 1 if chance.random() < _MARGIN else -1, record.tick)]
        if self._happens(settings.appraises_every_s):
            return [Appraise(self._next_id(), NAME, chance.choice(self._appraisals), record.tick)]
        picture = view_of_tick(record)
        if not picture.asking and self._corrected >= self._most_corrections:
            return []  # he looks on
        command = self._scripted.update(picture)
        if isinstance(command, Correct):
            self._corrected += 1
        return [] if command is None else [command]

    def _take_back(self, record: TickRecord) -> list[Command]:
        return [Take(self._next_id(), NAME)] if record.tick % _TAKES_EVERY_TICKS == 0 else []

    def _resume(self, record: TickRecord) -> list[Command]:
        """Return the command to resume after a reaction time."""
        self._stopped_ticks += 1
        waits = self._resumes_in or round(max(_LEAST_REACTION_S, self._settings.reaction_s) / self._period_s)
        if self._stopped_ticks < waits:
            return []
        self._stopped_ticks = self._resumes_in = 0
        return [Resume(self._next_id(), NAME, record.tick)]

    def _change_mood(self) -> None:
        moods, chance = self._soak.moods, self._chance
        (self.mood,) = chance.choices(list(moods), [mood.share for mood in moods.values()])
        settings = self._settings = moods[self.mood]
        self._moods += 1
        self._mood_left = max(1, round(chance.uniform(*settings.lasts_s) / self._period_s))
        self._scripted = ScriptedTeacher(
            self._task.policy.build(self._robot.infrared),
            self._actions,
            TeacherSettings(
                reaction_s=settings.reaction_s, patience_s=settings.patience_s, error_rate=settings.error_rate
            ),
            replace_radius_fraction=self._task.learning.insert_beyond_share,
            period_s=self._period_s,
            seed=chance.getrandbits(32),
            session=f"mood-{self._moods}",
        )
        self._most_corrections = max(self._soak.first_corrections, self._corrected + settings.most_corrections)
        phase = Phase(settings.phase)
        self._scripted.phase = phase
        self._begins = [SetPhase(self._next_id(), NAME, phase)]

    def _happens(self, every_s: float) -> bool:
        return every_s > 0.0 and self._chance.random() < self._period_s / every_s

    def _next_id(self) -> str:
        self.sent += 1
        return f"soak-{self.sent}"
