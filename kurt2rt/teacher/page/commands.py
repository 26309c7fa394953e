"""Commands of the page: fields of each, the call of the robot, and the oldest state that it may be given on."""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import Any

from kurt2rt.channel.protocol.limits import FASTEST, SHA256_BYTES, UPLOAD_ID_BYTES
from kurt2rt.channel.protocol.requests import PACKAGE
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.core.teaching import commands
from kurt2rt.core.teaching.message_fields import (
    LARGEST_NUMBER,
    MOST_SEGMENTS,
    Bytes,
    Check,
    Flag,
    Float,
    Int,
    ListOf,
    OrNone,
    Text,
    WireError,
    checks_of,
)
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.client import TeacherClient

_NAME, _LEVEL = (checks_of(commands.Teach)[name] for name in ("action", "level"))
_NUMBER = Int(0, LARGEST_NUMBER)
_PLACE_M = Float(100.0, "m")
_MOTION_S = 1.0
_OTHER_S = 3.0

_Arguments = Mapping[str, Any]
_Send = Callable[[TeacherClient, _Arguments, int | None], Awaitable[Answer]]
"""Robot, checked arguments, tick of the state that the page showed; raises NoAnswerError."""


@dataclass(frozen=True, slots=True)
class PageCommand:
    """Command that is answered, as a page sent it."""

    number: int
    name: str
    """Key of COMMANDS."""
    arguments: _Arguments
    picture: int | None
    """Number of the state on the page's screen."""


@dataclass(frozen=True, slots=True)
class CommandKind:
    """Command of the page: the call that sends it, checks of its fields, and what it may do."""

    send: _Send
    fields: Mapping[str, Check]
    moves: bool = False
    """It may set the robot in motion, so the state must not be older than 1 s; otherwise 3 s."""
    ends_run: bool = False
    """The robot's run ends: its wheels stand, and no more states of this run come."""


def _hexadecimal(length: int) -> Check:
    def check(what: str, value: object) -> bytes:
        try:
            return Bytes(length)(what, bytes.fromhex(value) if isinstance(value, str) else None)
        except ValueError as error:
            raise WireError(f"{what} has to be {2 * length} hexadecimal digits") from error

    return check


def _single(kind: type[commands.Single], send: _Send) -> CommandKind:
    """Return the command of the page for one of the tick: the page sends its fields, but for the tick that is meant."""
    checks = {name: check for name, check in checks_of(kind).items() if name != "decision_tick"}
    return CommandKind(send, checks, moves=kind.moves)


COMMANDS: Mapping[str, CommandKind] = {
    "answer": CommandKind(
        lambda robot, given, tick: robot.answer(
            given["action"], of=tick, level=given["level"], alternative=given["beside"]
        ),
        {"action": _NAME, "level": _LEVEL, "beside": Flag()},
    ),
    "correct": CommandKind(
        # A person reacts late; the robot knows by how much, and its answer says which decision it corrected.
        lambda robot, given, tick: robot.correct(
            given["action"], of=tick, level=given["level"], late=given["level"] == BASIC
        ),
        {"action": _NAME, "level": _LEVEL},
    ),
    # Tick of an earlier state, which the page kept and the teacher picked; the robot checks that it still knows it.
    "correct_at": CommandKind(
        lambda robot, given, _: robot.correct(given["action"], of=given["tick"]),
        {"action": _NAME, "tick": _NUMBER},
    ),
    "teach_shown": CommandKind(
        lambda robot, given, _: robot.teach_shown(given["segments"], press_id=given["press_id"]),
        {"press_id": _NUMBER, "segments": ListOf(Int(0, MOST_SEGMENTS - 1), most=MOST_SEGMENTS)},
    ),
    "reward": _single(commands.Reward, lambda robot, given, tick: robot.reward(given["value"], of=tick)),
    "appraise": _single(commands.Appraise, lambda robot, given, tick: robot.appraise(given["appraisal"], of=tick)),
    # By id: "the last lesson" would be another one if a second teacher taught meanwhile.
    "undo": CommandKind(lambda robot, given, _: robot.undo(given["lesson"]), {"lesson": Text(128, least=1)}),
    "phase": _single(commands.SetPhase, lambda robot, given, _: robot.set_phase(given["phase"])),
    "lesson_speed": _single(commands.SetLessonSpeed, lambda robot, given, _: robot.set_lesson_speed(given["percent"])),
    "pursue": _single(commands.Pursue, lambda robot, given, _: robot.pursue(given["behaviour"])),
    "name": _single(commands.NameSituation, lambda robot, given, tick: robot.name_situation(given["name"], of=tick)),
    "seek": CommandKind(lambda robot, given, _: robot.seek(given["name"]), {"name": _NAME}, moves=True),
    "stop_seeking": _single(commands.StopSeeking, lambda robot, *_: robot.stop_seeking()),
    "be_at": _single(commands.BeAt, lambda robot, given, _: robot.set_location(given["name"])),
    "begin_session": _single(commands.BeginSession, lambda robot, given, _: robot.begin_session(given["name"])),
    "end_session": _single(commands.EndSession, lambda robot, *_: robot.end_session()),
    "resume": _single(commands.Resume, lambda robot, *_: robot.resume()),
    "take": _single(commands.Take, lambda robot, *_: robot.take()),
    "hand_over": _single(commands.HandOver, lambda robot, given, _: robot.hand_over(given["to"])),
    "save": CommandKind(lambda robot, given, _: robot.save(given["label"]), {"label": Text(64)}),
    "export": CommandKind(lambda robot, *_: robot.export(PACKAGE), {}),
    "examine": CommandKind(lambda robot, *_: robot.examine(), {}),
    "move": CommandKind(
        lambda robot, given, _: robot.move_wall(given["name"], given["dx_m"], given["dy_m"]),
        {"name": _NAME, "dx_m": _PLACE_M, "dy_m": _PLACE_M},
    ),
    "put_back": CommandKind(lambda robot, *_: robot.put_back(), {}, moves=True),
    "speed": CommandKind(lambda robot, given, _: robot.set_speed(given["times"]), {"times": Int(1, FASTEST)}),
    "load": CommandKind(
        lambda robot, given, _: robot.load_upload(given["upload"], given["sha256"]),
        {"upload": _hexadecimal(UPLOAD_ID_BYTES), "sha256": _hexadecimal(SHA256_BYTES)},
        ends_run=True,
    ),
    "next_run": CommandKind(
        lambda robot, given, _: robot.next_run(given["world"], given["task"], fresh=given["fresh"]),
        {"world": OrNone(_NAME), "task": OrNone(_NAME), "fresh": Flag()},
        ends_run=True,
    ),
    "place": CommandKind(
        lambda robot, given, _: robot.place(given["x_m"], given["y_m"], given["heading_rad"]),
        {"x_m": _PLACE_M, "y_m": _PLACE_M, "heading_rad": Float(7.0, "rad")},
        moves=True,
    ),
}


def max_state_age_s(command: PageCommand) -> float:
    """Return the oldest state that a command may be given on, in s: the robot's limits, for the page's own link."""
    return _MOTION_S if COMMANDS[command.name].moves or is_resumption(command) else _OTHER_S


def is_resumption(command: PageCommand) -> bool:
    """Return whether a standing robot may drive after a command; it is refused if a stop came after the state."""
    return command.name == "resume" or (command.name == "phase" and command.arguments["phase"] == Phase.AUTONOMOUS)
