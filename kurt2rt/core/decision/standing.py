"""Standing: whether the robot drives after a tick, and if not, why and whether it waits for Go.

The one source of this for page, terminal, status line, status and channel. `kurt2rt.core.decision.standing_text` holds
its texts.
"""

from enum import StrEnum
from typing import NamedTuple

from hal.guard_reason import GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.core.decision.active_stop import ActiveStop
from kurt2rt.core.decision.decision import Cause, Decision
from kurt2rt.core.rla.rla import MID


class StandReason(StrEnum):
    """Why the wheels stand."""

    DRIVES = "drives"
    """They do not."""
    ASKS = "asks"
    """The basic level does not know its situation."""
    ASKS_THE_WAY = "asks the way"
    """The mid level does not."""
    FRONT_BUMPER = "front bumper"
    """The robot touches something in front, and is to drive on toward it."""
    REAR_BUMPER = "rear bumper"
    BOTH_BUMPERS = "both bumpers"
    STOPPED = "stopped"
    """A teacher stopped the robot, or it lost its teacher, or it was just started."""
    UNATTENDED = "unattended"
    BLIND = "blind"
    UNSAVED = "unsaved"
    AT_GOAL = "at goal"
    NO_WAY = "no way"
    COMPUTER_TOO_SLOW = "computer too slow"
    """The second guard braked, for ticks had ceased; until Go."""
    BUS_LOST = "bus lost"
    BUS_BLOCKED = "bus blocked"
    BUS_OFF = "bus off"
    FOREIGN_CONTROL = "foreign control"
    WHEELS_DISOBEY = "wheels disobey"
    INFRARED_FROZEN = "infra-red frozen"
    HALTED = "halted"
    """The robot program itself had the guard stop the robot: it ends, or waits for what it needs."""
    LATE = "late"
    """Decisions are too old when they come to the guard."""
    CLOCK = "clock"
    """The computer's clock ran backwards."""
    ENCODERS_SILENT = "encoders silent"
    BUMPERS_SILENT = "bumpers silent"
    NOT_A_NUMBER = "not a number"
    """The decided speed is not a number."""


class Standing(NamedTuple):
    """Whether the robot drives, and if not why."""

    reason: StandReason = StandReason.DRIVES
    needs_resume: bool = False
    """Whether the robot stands until its teacher says Go, whatever else ends."""
    asks: bool = False
    """Whether an answer of its teacher lets it drive on."""
    stall_s: float | None = None
    """For how long no tick ran before the second guard braked, where that is the reason; None else."""
    says: str = ""
    """Details that the reason lacks: the goal's outcome, the disk's error."""
    stop: ActiveStop | None = None
    """Actor and kind of the stop, of STOPPED only."""


DRIVES = Standing()

LATCHED: dict[str, StandReason] = {
    GuardReason.TICKS_CEASED: StandReason.COMPUTER_TOO_SLOW,
    GuardReason.BUS_LOST: StandReason.BUS_LOST,
    GuardReason.BUS_BLOCKED: StandReason.BUS_BLOCKED,
    GuardReason.BUS_OFF: StandReason.BUS_OFF,
    GuardReason.FOREIGN_CONTROL: StandReason.FOREIGN_CONTROL,
    GuardReason.WHEELS_DISOBEY: StandReason.WHEELS_DISOBEY,
    GuardReason.INFRARED_FROZEN: StandReason.INFRARED_FROZEN,
}
"""By the guard's word for why it keeps the robot stopped; any other word is one that the program gave it."""

_HELD: dict[str, StandReason] = {
    GuardReason.INFRARED_STALE: StandReason.BLIND,
    GuardReason.ENCODER_STALE: StandReason.ENCODERS_SILENT,
    GuardReason.BUMPER_STALE: StandReason.BUMPERS_SILENT,
    GuardReason.COMMAND_TOO_OLD: StandReason.LATE,
    GuardReason.CLOCK_RAN_BACKWARDS: StandReason.CLOCK,
    GuardReason.NOT_A_NUMBER: StandReason.NOT_A_NUMBER,
}
"""By the guard's word for what it lets no set point through, tick by tick."""

_CAUSES = {
    Cause.STOPPED: StandReason.STOPPED,
    Cause.UNATTENDED: StandReason.UNATTENDED,
    Cause.BLIND: StandReason.BLIND,
    Cause.UNSAVED: StandReason.UNSAVED,
    Cause.AT_GOAL: StandReason.AT_GOAL,
    Cause.NO_WAY: StandReason.NO_WAY,
}


def standing_for(cause: str, asks_at: str, stop: ActiveStop | None, says: str = "") -> Standing:
    """Return the standing of a robot that no guard holds, from why it decided to stand.

    Args:
        cause: a value of Cause; one that is not known here stands without a reason of its own.
        asks_at: the level that does not know its situation, where `cause` says that one does not.
        stop: the one that holds until Go; None while none does.
        says: in words what came of the goal, or why lessons cannot be saved.
    """
    asks = cause in (Cause.UNKNOWN, Cause.TOUCHES)
    if stop is not None:
        return Standing(StandReason.STOPPED, True, asks, stop=stop)
    if cause == Cause.UNKNOWN:
        return Standing(StandReason.ASKS_THE_WAY if asks_at == MID else StandReason.ASKS, asks=True)
    if cause == Cause.TOUCHES:
        return Standing(StandReason.FRONT_BUMPER, asks=True)
    if cause in (Cause.RLA, Cause.HELD, Cause.TEACHER):
        return DRIVES
    if cause not in Cause.__members__.values():
        return Standing(StandReason.HALTED, says=cause)
    return Standing(_CAUSES[Cause(cause)], says=says)


ASKS_AFTER_TICKS = 50
"""For so long a bumper has to hold what an RLA wants before the robot asks: 0.5 s, for a brush is over sooner."""

HELD_TICKS = 10
"""For so long a set point has to be held back before the robot is told to stand: a late tick is over in one."""


def standing_latched(reasons: tuple[str, ...], *, asks: bool = False, stall_s: float | None = None) -> Standing:
    """Return the standing of a robot that the guard keeps stopped for `reasons`, after a stall of `stall_s`."""
    word = reasons[0] if reasons else ""
    reason = LATCHED.get(word, StandReason.HALTED)
    if reason is StandReason.HALTED:
        return Standing(reason, True, asks, says=word)
    return Standing(reason, True, asks, stall_s if reason is StandReason.COMPUTER_TOO_SLOW else None)


def touched_bumper(wheel_speeds: WheelSpeeds, reasons: tuple[str, ...]) -> StandReason | None:
    """Return which bumpers hold wheels that were to drive on; None where they turn, or none of the bumpers holds.

    Args:
        wheel_speeds: what the guard let through.
        reasons: why that differs from what was wanted, in the guard's words.
    """
    if wheel_speeds != STANDSTILL:
        return None
    front, rear = GuardReason.FRONT_BUMPER in reasons, GuardReason.REAR_BUMPER in reasons
    if front and rear:
        return StandReason.BOTH_BUMPERS
    return StandReason.FRONT_BUMPER if front else StandReason.REAR_BUMPER if rear else None


class BumperWatch:
    """Notices that an RLA goes on toward what a bumper touches, so that the guard lets no wheel turn.

    A bumper may spring back while nothing pushes it: ticks in which the wheels turn end the wait only when there were
    as many of them.
    """

    def __init__(self) -> None:
        self._held_ticks = self._free_ticks = 0

    def update(self, decision: Decision, grant: GuardResult) -> bool:
        """Return whether the robot is held now, and has been for ASKS_AFTER_TICKS."""
        pushes = decision.cause in (Cause.RLA, Cause.HELD) and not grant.latched
        held = pushes and touched_bumper(grant.wheel_speeds, grant.reasons) is not None
        if held:
            self._held_ticks = min(self._held_ticks + 1, ASKS_AFTER_TICKS)
            self._free_ticks = 0
        else:
            self._free_ticks += 1
            if self._free_ticks >= ASKS_AFTER_TICKS:
                self._held_ticks = 0
        return held and self._held_ticks >= ASKS_AFTER_TICKS


class StandingWatch:
    """Tells after each tick whether the robot drives, and if not why; remembers how long a stall lasted."""

    def __init__(self) -> None:
        self._drove_at_s: float | None = None
        self._latched = False
        self._stall_s: float | None = None
        self._held: StandReason | None = None
        self._held_ticks = 0

    def update(
        self, decision: Decision, grant: GuardResult, drove_at_s: float, stop: ActiveStop | None, trouble: str | None
    ) -> Standing:
        """Return the standing after one tick.

        Args:
            decision: of the tick, as it is told.
            grant: what the guard let through.
            drove_at_s: when the guard was asked, on the runtime's clock.
            stop: the one that holds until Go; None while none does.
            trouble: why lessons cannot be saved; None while they can.
        """
        if grant.latched and not self._latched:
            self._stall_s = None if self._drove_at_s is None else drove_at_s - self._drove_at_s
        self._latched = grant.latched
        self._drove_at_s = drove_at_s
        held = self._held_back(decision, grant)
        asks = decision.asking
        if grant.latched:
            return standing_latched(grant.reasons, asks=asks, stall_s=self._stall_s)
        if held is not None:
            return Standing(held, asks=asks)
        if decision.driving:
            return DRIVES
        says = trouble if trouble is not None else "" if decision.plan is None else decision.plan.says
        return standing_for(decision.cause, decision.asks_at, stop, says)

    def _held_back(self, decision: Decision, grant: GuardResult) -> StandReason | None:
        """Return why the guard lets none of what was decided through, once it has for some ticks."""
        if decision.cause is Cause.TOUCHES and not grant.latched:
            return touched_bumper(grant.wheel_speeds, grant.reasons)
        if grant.latched or not decision.driving:
            self._held, self._held_ticks = None, 0
            return None
        bumpers = touched_bumper(grant.wheel_speeds, grant.reasons)
        if bumpers is not None:
            return bumpers
        held = next((_HELD[each] for each in grant.reasons if each in _HELD), None)
        self._held_ticks = self._held_ticks + 1 if held is not None and held is self._held else 0
        self._held = held
        return held if self._held_ticks >= HELD_TICKS else None
