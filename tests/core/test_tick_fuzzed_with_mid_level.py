"""A teacher gone mad at a robot with a mid level: whatever is said, and in whichever order, the rules hold."""

import math
import random
from collections.abc import Callable, Sequence

import pytest

from hal.robot import STANDSTILL
from kurt2rt.core.decision.decision import Decision, DecisionCause, GoalStatus
from kurt2rt.core.decision.goal import Goal, NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.rla.rla import BASIC, CRITIC, MID, Phase
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.core.teaching.commands import (
    BeAt,
    Command,
    Correct,
    DeleteRla,
    Drive,
    HandOver,
    NameSituation,
    Pursue,
    ReplaceAction,
    Resume,
    Reward,
    RunBehaviour,
    Seek,
    SetPhase,
    Stop,
    StopSeeking,
    Take,
    Teach,
    Undo,
    Watch,
)
from tests.channel.channel_fixture import ROBOT
from tests.core.test_tick_seeking import PLACES
from tests.core.test_tick_with_mid_level import (
    BEHAVIOURS,
    OPEN,
    ROUTE,
    STEP_M,
    WALL,
    Town,
    basic_knowledge,
)

_LEGS_TICKS = (10, 40)


class Bedlam(Town):
    """A robot that needs a teacher, in streets drawn by chance, with one who says anything."""

    def __init__(self, task: TaskSettings, seed: int, events: Sequence[TeachingEvent] = ()) -> None:
        """`events`: what was taught in a run before."""
        super().__init__([*basic_knowledge(), *events], task=task, attended=True)
        self.chance = random.Random(seed)
        self.said: list[str] = ["nothing"]
        self._leg_ticks = 0

    def moment(self) -> Decision:
        """One tick, with whatever is said in it."""
        chance = self.chance
        self._drive_on()
        if chance.random() < 0.002:
            self.runtime.reposition()
        commands: list[Command] = [Watch("Ann", max(0, self.tick - chance.choice((0, 0, 0, 60))))]
        commands += [self._anything() for _ in range(chance.choice((0, 0, 0, 1, 1, 2, 5)))]
        return self.run(*commands[chance.random() < 0.1 :]).decision

    def _drive_on(self) -> None:
        if self._leg_ticks == 0:
            self._leg_ticks = self.chance.randrange(*_LEGS_TICKS)
            self.robot.counts = self.chance.choice((WALL, OPEN))
            quarters = self.chance.choice((0, 0, 1, -1, 2)) if self.robot.counts == OPEN else 0
            off_m = quarters * math.pi / 2 * ROBOT.geometry.effective_track_m / 2 / self._leg_ticks
            step_m = self.chance.choice((STEP_M, STEP_M, 0.0))
            self.robot.left_m, self.robot.right_m = step_m - off_m, step_m + off_m
        self._leg_ticks -= 1

    def _anything(self) -> Command:
        chance, tick = self.chance, self.tick
        command_id = f"c{len(self.said)}" if chance.random() < 0.95 else chance.choice(self.said)
        self.said.append(command_id)
        who = chance.choice(("Ann", "Ann", "Ann", "Bob"))
        seen = chance.choice((None, tick, tick, max(0, tick - chance.randrange(100))))
        meant = chance.choice((None, None, tick, max(0, tick - chance.randrange(400)), tick + 5))
        level = chance.choice((BASIC, MID, MID, MID, CRITIC))
        way, action = chance.choice((*BEHAVIOURS, "fly")), chance.choice(("forward", "spin_left", "backward", "fly"))
        what = way if level == MID else action
        name = chance.choice(("door", "yard", "home", " ", ""))
        rla_id = chance.randrange(self.runtime.level.system.next_id + 2)
        phase = Phase(chance.choice((1, 1, 1, 2, 3, 4, 5)))
        may_say: tuple[Callable[[], Command], ...] = (
            lambda: Teach(command_id, who, what, meant, level, alternative=chance.random() < 0.5),
            lambda: Correct(command_id, who, what, meant, level),
            lambda: ReplaceAction(command_id, who, rla_id, chance.choice((way, action))),
            lambda: DeleteRla(command_id, who, rla_id),
            lambda: Reward(command_id, who, chance.choice((1, -1)), meant),
            lambda: Undo(command_id, who, chance.choice((None, chance.choice(self.said)))),
            lambda: Pursue(command_id, who, way, seen),
            lambda: NameSituation(command_id, who, name, meant),
            lambda: Seek(command_id, who, self._goal(rla_id), seen),
            lambda: StopSeeking(command_id, who, seen),
            lambda: BeAt(command_id, who, name, seen),
            lambda: SetPhase(command_id, who, phase, seen),
            lambda: Take(command_id, who),
            lambda: HandOver(command_id, who, chance.choice((None, "Bob", "Ann"))),
            lambda: RunBehaviour(command_id, who, action, chance.randrange(1, 30), seen),
            lambda: Drive(who, tick, len(self.said), 0.1, 0.1),
            lambda: Stop(command_id, who),
        )
        resumes: tuple[Callable[[], Command], ...] = (lambda: Resume(command_id, who, seen),) * 4
        return chance.choice((*may_say, *resumes))()

    def _goal(self, rla_id: int) -> Goal:
        feature = self.chance.choice(("x_m", "east", "symbol 1", "wall_left"))
        like = PartialGoal(((feature, float(self.chance.randrange(-2, 3))),), 0.6)
        return self.chance.choice((NamedGoal("door"), NamedGoal("yard"), RlaGoal(rla_id), like, PartialGoal(())))

    def may_drive(self, decision: Decision) -> bool:
        """Return whether each rule lets wheels turn for a decision."""
        school, mid = self.runtime.handler, self.runtime.mid
        assert mid is not None
        if decision.cause is DecisionCause.TEACHER:
            return school.authority.is_manual(self.tick)
        there = school.authority.is_present(self.tick) or school.phase is Phase.AUTONOMOUS
        stands_at_goal = decision.plan is not None and decision.plan.course in (GoalStatus.ARRIVED, GoalStatus.NO_WAY)
        asks = decision.mid is None or decision.mid.asks
        return there and not school.stops.active and not asks and (mid.overridden or not stands_at_goal)


def check(task: TaskSettings, seed: int, ticks: int) -> None:
    town, again = Bedlam(task, seed), Bedlam(task, seed)
    drove = 0
    for _ in range(ticks):
        decision = town.moment()
        assert again.moment() == decision
        if decision.wheel_speeds != STANDSTILL:
            drove += 1
            assert town.may_drive(decision), (town.tick, decision)
    assert drove > ticks // 50
    system, saved = town.runtime.level.system, town.runtime.snapshot()
    known = {rla.rla_id for level in (BASIC, MID) for rla in system.rlas_at(level)}
    assert known.issuperset(rla_id for edge in saved.transitions for rla_id in edge)
    assert known.issuperset(saved.expectations)
    reopened = Bedlam(task, seed, town.notebook.events).runtime.level.system
    assert reopened.knowledge_hash() == system.knowledge_hash()
    assert reopened.named_situations(MID) == system.named_situations(MID)
    assert reopened.history.records == system.history.records


@pytest.mark.parametrize("task", [ROUTE, PLACES], ids=["histories", "places"])
def test_random_commands_keep_rules_and_lessons(task: TaskSettings) -> None:
    check(task, seed=1, ticks=800)


@pytest.mark.deep
@pytest.mark.parametrize("seed", range(10, 30))
@pytest.mark.parametrize("task", [ROUTE, PLACES], ids=["histories", "places"])
def test_many_random_commands_keep_rules_and_lessons(task: TaskSettings, seed: int) -> None:
    check(task, seed, ticks=4000)
