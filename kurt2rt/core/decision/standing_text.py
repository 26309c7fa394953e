"""Texts of Standing: why the robot stands, and what the teacher can do."""

from typing import NamedTuple

from kurt2rt.core.decision.active_stop import ActiveStop, StopReason
from kurt2rt.core.decision.standing import Standing, StandReason

GO_ON_PAGE = "GO lets it drive on"
GO_IN_TERMINAL = "Type go to let it drive on"


class _Text(NamedTuple):
    why: str
    """Continues "stands: "; placeholders are fields of Standing."""
    to_do: str = ""
    """Separate sentence; it precedes the resume if the robot stands until then."""


_TEXTS: dict[StandReason, _Text] = {
    StandReason.DRIVES: _Text(""),
    StandReason.ASKS: _Text("it does not know this situation", "Teach it what to do here"),
    StandReason.DOUBTS: _Text("it doubts that its action is right here", "Teach it what to do here"),
    StandReason.ASKS_THE_WAY: _Text("it does not know the way", "Teach it which behaviour to follow"),
    StandReason.FRONT_BUMPER: _Text("it touches something in front", "Drive it back"),
    StandReason.REAR_BUMPER: _Text("it touches something behind", "Drive it forward"),
    StandReason.BOTH_BUMPERS: _Text("it touches something in front and behind", "Set it free"),
    StandReason.STOPPED: _Text("{stop}"),
    StandReason.UNATTENDED: _Text("no teacher looks at it", "Take the robot"),
    StandReason.BLIND: _Text("its range sensors are silent", "Check its power and cable"),
    StandReason.UNSAVED: _Text("lessons cannot be saved", "Look at the disk"),
    StandReason.AT_GOAL: _Text("{says}"),
    StandReason.NO_WAY: _Text("{says}"),
    StandReason.COMPUTER_TOO_SLOW: _Text("the computer was too slow{stall}"),
    StandReason.BUS_LOST: _Text("its bus is lost", "Check its power and cable"),
    StandReason.BUS_BLOCKED: _Text("its bus carries nothing", "Check its power, cable and bit rate"),
    StandReason.BUS_OFF: _Text("its bus failed too often", "Check cable, termination and bit rate"),
    StandReason.FOREIGN_CONTROL: _Text("another program drives it, too", "Find and end that one"),
    StandReason.FOREIGN_TELEMETRY: _Text("another program sends its readings, too", "Find and end that one"),
    StandReason.WHEELS_DISOBEY: _Text("its wheels disobey", "Set them free, or switch it off and on"),
    StandReason.INFRARED_FROZEN: _Text("its range sensors are frozen", "Switch it off and on"),
    StandReason.ROBOT_FAULT: _Text("it reports a fault of its own", "Mend what it names"),
    StandReason.HALTED: _Text("{says}"),
    StandReason.LATE: _Text("the computer is too slow", "End other work on it"),
    StandReason.CLOCK: _Text("the computer's clock ran backwards", "Wait until it is right again"),
    StandReason.ENCODERS_SILENT: _Text("its encoders are silent", "Check its power and cable"),
    StandReason.BUMPERS_SILENT: _Text("its bumpers are silent", "Check its power and cable"),
    StandReason.NOT_A_NUMBER: _Text("the decided speed is not a number", "Teach it another action here"),
    StandReason.LEARNER_FAILED: _Text("its learner failed: {says}", "Mend it and begin again"),
}

_STOPS: dict[StopReason, str] = {
    StopReason.SAID_STOP: "{name} said stop",
    StopReason.LET_GO: "{name} drove by hand and let go",
    StopReason.SESSION_OVER: "the session {name!r} is over",
    StopReason.BEHAVIOUR_OVER: "{name} is over",
    StopReason.NO_TEACHER: "no teacher is there",
    StopReason.TEACHER_NOT_YET: "{name} is not there yet",
    StopReason.LINK_LOST: "lost the link to {name}",
    StopReason.FALLS_BEHIND: "the computer is too slow for {name} times real time; the simulation is back in real time",
    StopReason.STARTED: "the robot program was started",
    StopReason.NEXT_RUN: "a new run was begun",
    StopReason.SENSOR_BROKEN: "its range sensor {name} is broken",
    StopReason.GUARD: "the guard: {name}",
}
"""Sentences of stops."""

_STOPS_TO_DO: dict[StopReason, str] = {
    StopReason.SENSOR_BROKEN: "The sensors next to it stand in for it. Check its plug and its lens",
}
"""Advice for stops that need more than a resume."""

_QUESTIONS = {
    StandReason.FRONT_BUMPER: "I touch something in front of me; what now?",
    StandReason.REAR_BUMPER: "I touch something behind me; what now?",
    StandReason.BOTH_BUMPERS: "I touch something in front of me and behind me; what now?",
}
"""Questions of a robot whose RLA pushes on toward what it touches."""


def stop_text(stop: ActiveStop | None) -> str:
    """Return the sentence of a stop; empty without one."""
    return "" if stop is None else _STOPS[stop.reason].format(name=stop.name)


def reason_text(standing: Standing) -> str:
    """Return the reason in a few words that continue "stands: "; empty while the robot drives."""
    stall = "" if standing.stall_s is None else f" for {standing.stall_s:.1f} s"
    return _TEXTS[standing.reason].why.format(
        says=standing.says or standing.reason, stop=stop_text(standing.stop) or standing.reason, stall=stall
    )


def question_text(standing: Standing) -> str:
    """Return the question of a robot at a bumper; empty if it asks nothing or something else."""
    return _QUESTIONS.get(standing.reason, "") if standing.asks and not standing.needs_resume else ""


def hindrance_text(standing: Standing) -> str:
    """Return what holds a robot that was resumed, and what to do about it, as the end of a sentence."""
    to_do = _TEXTS[standing.reason].to_do
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
    to_do = _TEXTS[standing.reason].to_do
    if standing.stop is not None:
        to_do = _STOPS_TO_DO.get(standing.stop.reason, to_do)
    if standing.needs_resume:
        to_do = f"{to_do}; then {go[0].lower() + go[1:] if go[:2] != 'GO' else go}" if to_do else go
    return f"Stands: {reason_text(standing)}" + (f". {to_do}" if to_do else "")
