"""Decision of one tick: wheel speeds, their cause, and the RLAs that were compared; what a level and a plan add."""

from enum import IntEnum, StrEnum
from typing import NamedTuple, Protocol

from config.errors import TextCode, UserError
from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from kurt2rt.core.outcome import CommandRefusedError, RefusalCode
from kurt2rt.core.perception.perception import Situation
from kurt2rt.core.rla.active_rlas import Match
from kurt2rt.core.rla.rla import BASIC

NAMES = {0: "straight", 1: "left", -1: "right", 2: "back"}
"""Names of the quarter turns."""


class JunctionEvent(NamedTuple):
    """Passed junction: a side was open, and now there are walls on both sides again."""

    quarters: int
    """Quarter turns to the left between the street it came from and the one it is in: 0, 1, -1 (right) or 2 (back)."""
    left_open: bool
    """True if there was a way to the left of the street it came from."""
    right_open: bool
    turn_rad: float
    """Angle by the encoders, in rad; positive to the left."""
    way_m: float
    """Distance from the end of the one street to the certain detection of the next, in m."""

    @property
    def name(self) -> str:
        """Return straight, left, right or back."""
        return NAMES[self.quarters]


class GoalStatus(StrEnum):
    """State of the way to the goal, after each tick."""

    NONE = "none"
    """No goal; the mid level commands by its RLAs."""
    PLANNING = "planning"
    """A plan is being computed. The robot goes on as it did: it stands, or the mid level commands."""
    UNDER_WAY = "under way"
    ARRIVED = "arrived"
    """The robot stands at the goal."""
    NO_WAY = "no way"
    """No known way leads to the goal, or the goal does not exist now; the robot stands."""
    LOST = "lost"
    """The robot is at no known place; it stands, and its mid level asks."""


class PlanStep(NamedTuple):
    """State of the drive to a goal in one tick: goal, status, and the behaviours planned to lead there."""

    goal: str
    """Goal in words."""
    course: GoalStatus
    behaviours: tuple[str, ...]
    """Behaviours that lead to the goal, the present one first."""
    rla_id: int | None
    """Mid-level RLA whose way the robot drives; None between ways."""
    says: str
    """Status in one line."""
    surprises: int
    """Number of arrivals at another place than planned, since the goal was given."""


class Severity(IntEnum):
    """Level of a reason to stand, in the numbers of ROS 2 diagnostics."""

    FINE = 0
    WAITS = 1
    """A teacher lets the robot drive on."""
    FAULT = 2
    """Something is broken."""


class StandReason(TextCode):
    """Code for why the wheels stand; DRIVES if they turn.

    It is a word of the wire contract: page, terminal, log, `kurt2rt status` and `kurt2rt why` word the same code. The
    guard's reason comes before a stop, and a stop before the decision's cause. Its text continues "stands: "; its
    fields are those of Standing. Its remedy is a sentence, and precedes the resume if the robot stands until then.
    """

    severity: Severity
    guard: GuardReason | None
    """Guard's reason whose texts these are; None if the guard does not hold the robot."""

    def __init__(self, _value: str, text: str = "", _do: str = "", severity: Severity = Severity.FAULT) -> None:
        """Keep what TextCode does not, and take the texts of the guard's reason that stands in place of `text`."""
        self.severity = severity
        self.guard = text if isinstance(text, GuardReason) else None
        if self.guard is not None:
            self.text, self.do = self.guard.text, self.guard.do

    DRIVES = ("drives", "", "", Severity.FINE)
    ASKS = ("asks", "it does not know this situation", "Teach it what to do here", Severity.WAITS)
    """The situation of the basic level is unknown."""
    DOUBTS = ("doubts", "it doubts that its action is right here", "Teach it what to do here", Severity.WAITS)
    """The situation of the basic level is known, but the robot doubts that the action is right."""
    ASKS_THE_WAY = ("asks the way", "it does not know the way", "Teach it which behaviour to follow", Severity.WAITS)
    """The situation of the mid level is unknown."""
    FRONT_BUMPER = ("front bumper", GuardReason.FRONT_BUMPER, "", Severity.WAITS)
    """The robot touches something in front and would drive on toward it."""
    REAR_BUMPER = ("rear bumper", GuardReason.REAR_BUMPER, "", Severity.WAITS)
    BOTH_BUMPERS = ("both bumpers", "it touches something in front and behind", "Set it free", Severity.WAITS)
    STOPPED = ("stopped", "{stop}", "", Severity.WAITS)
    """A teacher stopped the robot, it lost its teacher, or it was just started."""
    UNATTENDED = ("unattended", "no teacher looks at it", "Take the robot", Severity.WAITS)
    BLIND = ("blind", GuardReason.INFRARED_STALE)
    UNSAVED = ("unsaved", "lessons cannot be saved", "Look at the disk")
    AT_GOAL = ("at goal", "{says}", "", Severity.FINE)
    NO_WAY = ("no way", "{says}", "", Severity.WAITS)
    COMPUTER_TOO_SLOW = ("computer too slow", GuardReason.TICKS_CEASED)
    BUS_LOST = ("bus lost", GuardReason.BUS_LOST)
    BUS_BLOCKED = ("bus blocked", GuardReason.BUS_BLOCKED)
    BUS_OFF = ("bus off", GuardReason.BUS_OFF)
    FOREIGN_CONTROL = ("foreign control", GuardReason.FOREIGN_CONTROL)
    FOREIGN_TELEMETRY = ("foreign telemetry", GuardReason.FOREIGN_TELEMETRY)
    WHEELS_DISOBEY = ("wheels disobey", GuardReason.WHEELS_DISOBEY)
    INFRARED_FROZEN = ("range sensors frozen", GuardReason.INFRARED_FROZEN)
    ROBOT_FAULT = ("robot fault", GuardReason.ROBOT_FAULT)
    HALTED = ("halted", "{says}")
    """The robot program stopped the robot, because it ends or waits for a dependency."""
    LATE = ("late", GuardReason.COMMAND_TOO_OLD)
    CLOCK = ("clock", GuardReason.CLOCK_RAN_BACKWARDS)
    ENCODERS_SILENT = ("encoders silent", GuardReason.ENCODER_STALE)
    BUMPERS_SILENT = ("bumpers silent", GuardReason.BUMPER_STALE)
    NOT_A_NUMBER = ("not a number", GuardReason.NOT_A_NUMBER)
    LEARNER_FAILED = ("learner failed", "its learner failed: {says}", "Mend it and begin again")


class DecisionCause(TextCode):
    """Code for why a decision sets these wheel speeds: what drives, or why the robot stands.

    Its text is the sentence of `kurt2rt why`; empty if the RLAs tell more.
    """

    stands: StandReason
    """Reason of a robot that the guard does not hold."""

    def __init__(self, _value: str, _text: str = "", _do: str = "", stands: StandReason = StandReason.DRIVES) -> None:
        """Keep what TextCode does not."""
        self.stands = stands

    RLA = "rla"
    """The situation lies inside the radius of the nearest RLA, whose action drives."""
    HELD = "held"
    """Another RLA is nearest now, but the minimum time of the action before is not over."""
    TEACHER = ("teacher", "{teacher} drives: {action}. No RLA was asked.")
    """A teacher drives by hand, or a reference policy drives."""
    UNKNOWN = ("unknown", "", "", StandReason.ASKS)
    """No RLA is near enough; the robot stands and asks."""
    BLIND = (
        "blind",
        "The readings of the range sensors {age}: there is no situation to decide on, nor to ask about.",
        "",
        StandReason.BLIND,
    )
    STOPPED = ("stopped", "The robot was stopped: {stop}. It waits for Go.", "", StandReason.STOPPED)
    UNATTENDED = (
        "unattended",
        "The robot knows what to do, but drives only while a teacher is there, and none is.",
        "",
        StandReason.UNATTENDED,
    )
    UNSAVED = (
        "unsaved",
        "Lessons cannot be saved at the moment{trouble}: the robot stands until they can.",
        "",
        StandReason.UNSAVED,
    )
    AT_GOAL = ("at goal", "{plan}.", "", StandReason.AT_GOAL)
    """The robot has reached its goal."""
    TOUCHES = ("touches", "", "", StandReason.FRONT_BUMPER)
    """An RLA pushes toward what a bumper touches and the guard lets no wheel turn; the robot asks."""
    DOUBT = ("doubt", "", "", StandReason.DOUBTS)
    """The situation lies inside the radius of the nearest RLA, but the robot doubts its action; it stands and asks."""
    NO_WAY = ("no way", "{plan}.", "", StandReason.NO_WAY)
    """No taught way leads from here to the goal."""
    LEARNER = ("learner", "A learner without RLAs drives: {action}. It gives no reasons for its decisions.")
    """A learner that is no RLA system knows the situation, and its action drives."""
    LEARNER_FAILED = (
        "learner failed",
        "The learner that decides failed{trouble}: the robot stands.",
        "",
        StandReason.LEARNER_FAILED,
    )


ASKING = frozenset({DecisionCause.UNKNOWN, DecisionCause.DOUBT, DecisionCause.TOUCHES})
"""Causes by which the robot waits for an answer."""

BY_RLA = frozenset({DecisionCause.RLA, DecisionCause.HELD})
"""Causes by which an RLA drives."""

BY_KNOWLEDGE = BY_RLA | {DecisionCause.LEARNER}
"""Causes by which a taught action drives, of an RLA or of another learner."""


class MidDecision(NamedTuple):
    """Mid level's part of a decision: the behaviour that the basic level is to drive in this tick."""

    behaviour: str
    """Active behaviour of the basic level; while the mid level asks, the last one."""
    rla_id: int | None
    """Mid-level RLA whose action this is; None while the level asks or a teacher overrides it."""
    match: Match | None
    """Nearest mid-level RLA, its distance, R and the runner-up; None before the first lesson of this level."""
    asks: bool
    """True if no RLA is near enough and no teacher overrides the level; the robot stands and asks."""
    overridden: bool
    """True while a teacher's command replaces the RLAs', until the next junction has been passed."""
    event: JunctionEvent | None
    """Junction that was passed in this tick; None without one."""


class Decision(NamedTuple):
    """Choice of one tick: wheel speeds in m/s, their cause, and the RLAs that were compared.

    A level returns one in each tick; the guard may still limit its speeds. Recording, page and `kurt2rt why` explain
    the robot from it. Without an action the speeds are 0.
    """

    wheel_speeds: WheelSpeeds
    cause: DecisionCause
    action: str | None
    """Name of the action that drives; None while the robot stands."""
    rla_id: int | None
    """RLA whose action drives; None while the robot stands or a teacher drives."""
    match: Match | None
    """Nearest RLA at this situation, its distance, R and the runner-up; None before the first lesson."""
    answers: bool = False
    """True if the situation lies inside the radius of the RLA that drives; outside it the RLA gets no reward."""
    asks_at: str = BASIC
    """Level that asks, if the cause is UNKNOWN; `match` is that level's."""
    mid: MidDecision | None = None
    """Command of the mid level; None without one."""
    plan: PlanStep | None = None
    """Progress toward the goal; None without a goal."""
    doubt: float | None = None
    """Doubt of the basic level about the action that drives, or would without it; None if the task sets none, and at
    standstill for another reason."""
    image: str = ""
    """Image in which the RLA that drives answers; empty if it does at its condition."""

    @property
    def driving(self) -> bool:
        """Return whether an action drives the wheels."""
        return self.action is not None

    @property
    def asking(self) -> bool:
        """Return whether the robot waits for an answer, because it does not know, doubts or touches something."""
        return self.cause in ASKING


def withdrawn_rla_in(decision: Decision) -> int | None:
    """Return the id of the basic level's RLA that waits for a new action; None if the robot asks for no such RLA."""
    match = decision.match
    if decision.cause is not DecisionCause.UNKNOWN or decision.asks_at != BASIC or match is None:
        return None
    return match.rla.rla_id if match.rla.is_withdrawn and match.distance <= match.radius else None


def stopped(decision: Decision, cause: DecisionCause | None) -> Decision:
    """Return the decision at standstill if a cause forbids driving, even if a faulty level would drive.

    Args:
        decision: of the level that was given `cause`.
        cause: reason to stand; None: the decision may drive and is returned unchanged.
    """
    if cause is None or (decision.wheel_speeds == STANDSTILL and not decision.driving):
        return decision
    return decision._replace(wheel_speeds=STANDSTILL, cause=cause, action=None, rla_id=None, answers=False, image="")


class Level(Protocol):
    """Layer of the mind that decides in each tick, such as the taught basic level or a reference policy."""

    def decide(self, situation: Situation, readings: SensorReadings, blocking_cause: DecisionCause | None) -> Decision:
        """Return the decision of this tick; with a blocking cause, one at standstill.

        `situation`: vector (d,).
        """
        ...


class UnknownActionError(UserError, ValueError):
    """Knowledge or a policy names an action that the repertoire lacks."""


class UnknownBehaviourError(UserError, ValueError):
    """Knowledge with an RLA of a taught behaviour that the task lacks, so that it cannot be used."""


class ActiveBehaviour:
    """Selection of one of a task's taught behaviours, such as turn_left; only its RLAs compete.

    Both levels share one: a teacher's `Pursue` or the mid level sets it, the basic level reads it. A task with a single
    behaviour has the name "".
    """

    def __init__(self, behaviours: tuple[str, ...] = ("",)) -> None:
        """`behaviours`: names to select from, the first active at the start; a single behaviour has no name."""
        self.behaviours = behaviours
        self.behaviour = behaviours[0]
        """Name of the active one."""

    def select(self, name: str) -> None:
        """Make another behaviour active. Raises CommandRefusedError, which lists the names."""
        if name not in self.behaviours:
            raise CommandRefusedError(RefusalCode.NO_BEHAVIOUR, behaviour=name, known=self.behaviours)
        self.behaviour = name
