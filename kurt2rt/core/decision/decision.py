"""What was decided in a tick, and the rule that decided it."""

from enum import StrEnum
from typing import NamedTuple

from hal.robot import STANDSTILL, WheelSpeeds
from kurt2rt.core.decision.junction_event import JunctionEvent
from kurt2rt.core.decision.plan_step import PlanStep
from kurt2rt.core.rla.match import Match
from kurt2rt.core.rla.rla import BASIC


class Cause(StrEnum):
    """Why the wheels are told what they are told."""

    RLA = "rla"
    """The nearest RLA answers, inside its radius."""
    HELD = "held"
    """Another RLA is nearest now; the action chosen before keeps its minimum time."""
    TEACHER = "teacher"
    """A teacher, or the policy that stands in for one, drives."""
    UNKNOWN = "unknown"
    """No RLA is near enough: the robot stands and asks."""
    BLIND = "blind"
    """The infra-red readings are old or never came: there is no situation to decide on, nor to ask about."""
    STOPPED = "stopped"
    """A teacher stopped the robot."""
    UNATTENDED = "unattended"
    """The robot knows what to do, but needs a teacher who is there, and none is."""
    UNSAVED = "unsaved"
    """Lessons cannot be saved at the moment: the robot stands until they are."""
    AT_GOAL = "at goal"
    """The robot has come to where it was sent."""
    TOUCHES = "touches"
    """The robot touches something, an RLA goes on toward it, and the guard lets no wheel turn: the robot asks."""
    NO_WAY = "no way"
    """From here nothing that was taught leads to where the robot was sent."""


class MidDecision(NamedTuple):
    """What the mid level commands in this tick."""

    behaviour: str
    """The taught behaviour of the basic level that is wanted; where the mid level asks, the one that was."""
    rla_id: int | None
    """The mid-level RLA whose action this is; None while it asks, or a teacher overrides it."""
    match: Match | None
    """Nearest mid-level RLA, its distance, R and the runner-up; None before the first lesson at this level."""
    asks: bool
    """Whether no RLA is near enough, and nobody overrides it: the robot stands and asks."""
    overridden: bool
    """Whether a teacher has commanded a behaviour that no RLA says here, until the next junction has been passed."""
    event: JunctionEvent | None
    """The junction that has been passed in this very tick."""


class Decision(NamedTuple):
    """One tick's decision."""

    wheel_speeds: WheelSpeeds
    cause: Cause
    action: str | None
    """Name of the action that drives; None while the robot stands."""
    rla_id: int | None
    """The RLA whose action drives; None while the robot stands or a teacher drives."""
    match: Match | None
    """Nearest RLA at this situation, its distance, R and the runner-up; None before the first lesson."""
    answers: bool = False
    """Whether the situation lies inside the radius of the RLA that drives; outside it nobody may blame it."""
    asks_at: str = BASIC
    """The level that does not know its situation, where one does not; `match` is that level's."""
    mid: MidDecision | None = None
    """What the mid level commands; None where there is none."""
    plan: PlanStep | None = None
    """How it stands with the goal; None while there is none."""

    @property
    def driving(self) -> bool:
        """Whether an action drives the wheels."""
        return self.action is not None

    @property
    def asking(self) -> bool:
        """Whether the robot stands until it is taught: it does not know this situation, or touches something."""
        return self.cause in (Cause.UNKNOWN, Cause.TOUCHES)


def withdrawn_rla_in(decision: Decision) -> int | None:
    """Return the basic level's RLA whose action was withdrawn, where the robot asks for another one; None elsewhere."""
    match = decision.match
    if decision.cause is not Cause.UNKNOWN or decision.asks_at != BASIC or match is None:
        return None
    return match.rla.rla_id if match.rla.is_withdrawn and match.distance <= match.radius else None


def stopped(decision: Decision, cause: Cause | None) -> Decision:
    """The decision of a level that was told to stand: one that fails, and would drive all the same, stands.

    `cause`: why it was told so; None: it was not, and may drive.
    """
    if cause is None or (decision.wheel_speeds == STANDSTILL and not decision.driving):
        return decision
    return decision._replace(wheel_speeds=STANDSTILL, cause=cause, action=None, rla_id=None, answers=False)
