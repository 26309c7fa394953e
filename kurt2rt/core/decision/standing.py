"""Standing: whether the robot drives after a tick, and if not, why and whether it waits for a resume.

The stop that lasts until a resume comes first. Page, terminal, status line, status and channel all read the standing,
and its texts at the end.
"""

from typing import NamedTuple

from config.errors import TextCode
from hal.guard_reason import Effect, GuardReason
from hal.robot import STANDSTILL, GuardResult, WheelSpeeds
from kurt2rt.core.decision.decision import ASKING, BY_KNOWLEDGE, Decision, DecisionCause, StandReason
from kurt2rt.core.message_fields import Finite, Line, Truth
from kurt2rt.core.rla.rla import MID


class StopReason(TextCode):
    """Code for why the robot stands until a teacher resumes, with its text."""

    SAID_STOP = ("said stop", "{name} said stop")
    LET_GO = ("let go", "{name} drove by hand and let go")
    """A teacher drove by hand and let go, or the press was lost."""
    BEHAVIOUR_OVER = ("behaviour over", "{name} is over")
    SESSION_OVER = ("session over", "the session {name!r} is over")
    NO_TEACHER = ("no teacher", "no teacher is there")
    TEACHER_NOT_YET = ("teacher not yet", "{name} is not there yet")
    """The robot drove, and its new teacher has sent no sign of presence yet."""
    LINK_LOST = ("link lost", "heard nothing from {name}")
    """The robot drove, and messages of its teacher ceased."""
    FALLS_BEHIND = (
        "falls behind",
        "the computer is too slow for {name} times real time; the simulation is back in real time",
    )
    """The same, because the computer was too slow for the speed of the simulation."""
    STARTED = ("started", "the robot program was started")
    NEXT_RUN = ("next run", "a new run was begun")
    """The same program began a new run."""
    SENSOR_BROKEN = (
        "sensor broken",
        "its range sensor {name} is broken",
        "The sensors next to it stand in for it. Check its plug and its lens",
    )
    """An infra-red sensor was noticed to be dead, stuck or unplugged."""
    GUARD = ("guard", "the guard: {name}")


class ActiveStop(NamedTuple):
    """Stop that lasts until a resume, with the name that its reason is about."""

    reason: StopReason
    name: Line = ""
    """Teacher, behaviour, session, sensor or the guard's code; empty if none is needed."""

    @property
    def teacher(self) -> str:
        """Name of the teacher who caused the stop or is missing; empty if the reason names none."""
        return self.name if self.reason in _OF_A_TEACHER else ""

    @property
    def is_automatic(self) -> bool:
        """Return whether the guard or a lost link caused the stop. A script may resume after these two only."""
        return self.reason in (StopReason.GUARD, StopReason.LINK_LOST, StopReason.FALLS_BEHIND)


_OF_A_TEACHER = (StopReason.SAID_STOP, StopReason.LET_GO, StopReason.TEACHER_NOT_YET, StopReason.LINK_LOST)

STARTED = ActiveStop(StopReason.STARTED)
NEXT_RUN = ActiveStop(StopReason.NEXT_RUN)


class Standing(NamedTuple):
    """Reason that the robot stands, or DRIVES, and what lets it drive on."""

    reason: StandReason = StandReason.DRIVES
    needs_resume: Truth = False
    """True if the robot stands until its teacher resumes it."""
    asks: Truth = False
    """True if an answer of its teacher lets it drive on."""
    stall_s: Finite | None = None
    """Time without a tick before the watchdog braked, in s, for COMPUTER_TOO_SLOW; None otherwise."""
    says: Line = ""
    """Details that the reason lacks, such as the disk's error."""
    stop: ActiveStop | None = None
    """Actor and kind of the stop, for STOPPED; None otherwise."""


DRIVES = Standing()

_BY_GUARD: dict[str, StandReason] = {each.guard: each for each in StandReason if each.guard is not None}
"""Reasons by the guard's code; the program itself gives any other code for an emergency stop."""

_HELD = {code: each for code, each in _BY_GUARD.items() if GuardReason(code).effect is Effect.BLOCKS}
"""Reasons by the guard's code for set points that it blocks tick by tick."""


def standing_for(cause: DecisionCause, asks_at: str, stop: ActiveStop | None, says: str = "") -> Standing:
    """Return the standing of a robot that the guard does not hold, from the cause of its decision.

    Args:
        cause: of its decision.
        asks_at: level that asks, if `cause` is UNKNOWN.
        stop: active stop; None without one.
        says: outcome of the goal, a learner's failure, or why lessons cannot be saved, in words.
    """
    asks = cause in ASKING
    if stop is not None:
        return Standing(StandReason.STOPPED, True, asks, stop=stop)
    if asks:
        way = cause is DecisionCause.UNKNOWN and asks_at == MID
        return Standing(StandReason.ASKS_THE_WAY if way else cause.stands, asks=True)
    return DRIVES if cause.stands is StandReason.DRIVES else Standing(cause.stands, says=says)


ASKS_AFTER_TICKS = 50
"""Ticks for which a bumper blocks an RLA before the robot asks: 0.5 s, because a brush is over sooner."""

HELD_TICKS = 10
"""Ticks for which a set point is blocked before the robot counts as standing; a late tick blocks a single one."""


def standing_latched(reasons: tuple[str, ...], *, asks: bool = False, stall_s: float | None = None) -> Standing:
    """Return the standing after an emergency stop of the guard for `reasons`, after a stall of `stall_s`, in s.

    `asks`: whether the robot also asks its teacher. `stall_s`: None if no stall caused the stop.
    """
    word = reasons[0] if reasons else ""
    reason = _BY_GUARD.get(word, StandReason.HALTED)
    if reason is StandReason.HALTED:
        return Standing(reason, True, asks, says=word)
    return Standing(reason, True, asks, stall_s if reason is StandReason.COMPUTER_TOO_SLOW else None)


def touched_bumper(wheel_speeds: WheelSpeeds, reasons: tuple[str, ...]) -> StandReason | None:
    """Return which bumpers block the wheels; None if a wheel turns or no bumper blocks.

    Args:
        wheel_speeds: set points that the guard applied.
        reasons: the guard's codes for why they differ from the decided ones.
    """
    if wheel_speeds != STANDSTILL:
        return None
    front, rear = GuardReason.FRONT_BUMPER in reasons, GuardReason.REAR_BUMPER in reasons
    if front and rear:
        return StandReason.BOTH_BUMPERS
    return StandReason.FRONT_BUMPER if front else StandReason.REAR_BUMPER if rear else None


_GO_DOES_NOT_HELP = (StandReason.BLIND, StandReason.UNSAVED, StandReason.UNATTENDED, StandReason.LEARNER_FAILED)
_SILENT = (GuardReason.INFRARED_STALE, GuardReason.ENCODER_STALE, GuardReason.BUMPER_STALE)


def hindrance_after_resume(standing: Standing, guard_result: GuardResult) -> Standing | None:
    """Return what holds the robot in the very tick of a resume; None if it may drive.

    `standing`: after the tick. `guard_result`: of the tick, because silent sensors count as standing only later.
    """
    if standing.needs_resume or standing.reason in _GO_DOES_NOT_HELP:
        return standing
    silent = next((_HELD[each] for each in guard_result.reasons if each in _SILENT), None)
    return None if silent is None else Standing(silent)


class BumperWatch:
    """Detector of an RLA that pushes toward what a bumper touches while the guard lets no wheel turn.

    A bumper may spring back between pushes, so the count starts again only after ASKS_AFTER_TICKS ticks without a
    push.
    """

    def __init__(self) -> None:
        self._held_ticks = self._free_ticks = 0

    def update(self, decision: Decision, guard_result: GuardResult) -> bool:
        """Count one tick; return whether a bumper blocks the robot now and has for ASKS_AFTER_TICKS.

        `decision`: of the tick. `guard_result`: set points that the guard applied to it, and why.
        """
        pushes = decision.cause in BY_KNOWLEDGE and not guard_result.latched
        held = pushes and touched_bumper(guard_result.wheel_speeds, guard_result.reasons) is not None
        if held:
            self._held_ticks = min(self._held_ticks + 1, ASKS_AFTER_TICKS)
            self._free_ticks = 0
        else:
            self._free_ticks += 1
            if self._free_ticks >= ASKS_AFTER_TICKS:
                self._held_ticks = 0
        return held and self._held_ticks >= ASKS_AFTER_TICKS


class StandingWatch:
    """Standing after each tick; remembers the length of the last stall."""

    def __init__(self) -> None:
        self._drove_at_s: float | None = None
        self._latched = False
        self._stall_s: float | None = None
        self._held: StandReason | None = None
        self._held_ticks = 0

    def update(
        self,
        decision: Decision,
        guard_result: GuardResult,
        drove_at_s: float,
        stop: ActiveStop | None,
        error: str | None,
    ) -> Standing:
        """Return the standing after one tick.

        Args:
            decision: of the tick, as it is published.
            guard_result: set points that the guard applied, and why.
            drove_at_s: time of the guard's call on the runtime's clock, in s.
            stop: active stop; None without one.
            error: reason that lessons cannot be saved, or else a learner's failure; None without either.
        """
        if guard_result.latched and not self._latched:
            self._stall_s = None if self._drove_at_s is None else drove_at_s - self._drove_at_s
        self._latched = guard_result.latched
        self._drove_at_s = drove_at_s
        held = self._held_back(decision, guard_result)
        if guard_result.latched:
            return standing_latched(guard_result.reasons, asks=decision.asking, stall_s=self._stall_s)
        if held is not None:
            return Standing(held, asks=decision.asking)
        if decision.driving:
            return DRIVES
        says = error if error is not None else "" if decision.plan is None else decision.plan.says
        return standing_for(decision.cause, decision.asks_at, stop, says)

    def _held_back(self, decision: Decision, guard_result: GuardResult) -> StandReason | None:
        """Return why the guard blocks the decision, after HELD_TICKS ticks or at a bumper; None if it does not."""
        driving, latched = decision.driving, guard_result.latched
        if not driving and not latched and decision.cause is DecisionCause.TOUCHES:
            return touched_bumper(guard_result.wheel_speeds, guard_result.reasons)
        if latched or not driving or not guard_result.reasons:
            self._held, self._held_ticks = None, 0
            return None
        bumpers = touched_bumper(guard_result.wheel_speeds, guard_result.reasons)
        if bumpers is not None:
            return bumpers
        held = next((_HELD[each] for each in guard_result.reasons if each in _HELD), None)
        self._held_ticks = self._held_ticks + 1 if held is not None and held is self._held else 0
        self._held = held
        return held if self._held_ticks >= HELD_TICKS else None


_SHORTEST_STALL_S = 0.05
"""A shorter stall would be told as 0.0 s; the robot time of a simulation does not stall at all."""
GO_ON_PAGE = "GO lets it drive on"
GO_IN_TERMINAL = "Type go to let it drive on"

_QUESTIONS = {
    StandReason.FRONT_BUMPER: "I touch something in front of me; what now?",
    StandReason.REAR_BUMPER: "I touch something behind me; what now?",
    StandReason.BOTH_BUMPERS: "I touch something in front of me and behind me; what now?",
}
"""Questions of a robot whose RLA pushes on toward what it touches."""


def stop_text(stop: ActiveStop | None) -> str:
    """Return the sentence of a stop; empty without one."""
    return "" if stop is None else stop.reason.text.format(name=stop.name)


def reason_text(standing: Standing) -> str:
    """Return the reason in a few words that continue "stands: "; empty while the robot drives."""
    stall = f" for {standing.stall_s:.1f} s" if (standing.stall_s or 0.0) >= _SHORTEST_STALL_S else ""
    return standing.reason.text.format(
        says=standing.says or standing.reason, stop=stop_text(standing.stop) or standing.reason, stall=stall
    )


def question_text(standing: Standing) -> str:
    """Return the question of a robot at a bumper; empty if it asks nothing or something else."""
    return _QUESTIONS.get(standing.reason, "") if standing.asks and not standing.needs_resume else ""


def hindrance_text(standing: Standing) -> str:
    """Return what holds a robot that was resumed, and what to do about it, as the end of a sentence."""
    to_do = standing.reason.do
    return reason_text(standing) + (f"; {to_do[0].lower()}{to_do[1:]}" if to_do else "")


def short_text(standing: Standing) -> str:
    """Return why the robot stands, for a status line; empty while it drives or asks what to do."""
    if standing.needs_resume:
        return f"stands until Go: {reason_text(standing)}"
    if standing.reason in (StandReason.DRIVES, StandReason.ASKS, StandReason.DOUBTS, StandReason.ASKS_THE_WAY):
        return ""
    return f"stands: {question_text(standing) or reason_text(standing)}"


def standing_headline(standing: Standing, go: str) -> str:
    """Return one or two sentences for the teacher: why the robot stands, and what to do; empty while it drives.

    Args:
        standing: of the robot.
        go: how the teacher resumes on this surface, as a sentence without its full stop.
    """
    question = question_text(standing)
    if question or standing.reason is StandReason.DRIVES:
        return question
    to_do = standing.reason.do
    if standing.stop is not None:
        to_do = standing.stop.reason.do or to_do
    if standing.needs_resume:
        to_do = f"{to_do}; then {go[0].lower() + go[1:] if go[:2] != 'GO' else go}" if to_do else go
    return f"Stands: {reason_text(standing)}" + (f". {to_do}" if to_do else "")
