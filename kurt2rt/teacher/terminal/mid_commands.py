"""Typed commands of the mid level: behaviours at junctions, and goals."""

from collections.abc import Awaitable, Sequence

from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Correct, Seek, StopSeeking, Teach
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.client import TeacherClient
from kurt2rt.teacher.terminal.terminal_text import expects_mid_answer

_MOST_DIGITS = 15


def mid_command(
    robot: TeacherClient, hello: Hello, words: Sequence[str], state: State | None
) -> Awaitable[Answer] | None:
    """Return the sending of a mid-level command in a line of `words`; None if the line is no such command.

    `state`: the newest one when the line was typed. Awaiting the result raises NoAnswerError.
    """
    command = None if hello.mid is None else _lesson(robot, hello, words, state)
    return _goal(robot, words) if command is None and hello.seeks else command


def _lesson(robot: TeacherClient, hello: Hello, words: Sequence[str], state: State | None) -> Awaitable[Answer] | None:
    tick = None if state is None else state.tick
    match words:
        case [behaviour] if _means_behaviour(behaviour, hello, state):
            if state is None or state.mid is None or expects_mid_answer(state.mid):
                return robot.send(Teach, action=behaviour, decision_tick=tick, level=MID)
            return robot.send(Correct, action=behaviour, decision_tick=tick, level=MID)
        case ["also", behaviour]:
            return robot.send(Teach, action=behaviour, decision_tick=tick, level=MID, alternative=True)
    return None


def _goal(robot: TeacherClient, words: Sequence[str]) -> Awaitable[Answer] | None:
    match words:
        case ["seek"]:
            return robot.send(StopSeeking)
        case ["seek", "rla", rla_id] if rla_id.isdecimal() and len(rla_id) <= _MOST_DIGITS:
            return robot.send(Seek, goal=RlaGoal(int(rla_id)))
        case ["seek", *goal]:
            return robot.send(Seek, goal=_features_in(goal) or NamedGoal(" ".join(goal)))
    return None


def _means_behaviour(name: str, hello: Hello, state: State | None) -> bool:
    """Return whether a name means the behaviour; an action of the same name goes first unless the mid level asks."""
    if name not in hello.behaviours:
        return False
    return name not in hello.actions or (state is not None and state.asks_at == MID)


def _features_in(words: Sequence[str]) -> PartialGoal | None:
    """Parse features and tolerance of a goal, such as x_m=1.8 wall_left=1 within 0.2; None for anything else."""
    tolerance = None
    if len(words) > 2 and words[-2] == "within":
        words, tolerance = words[:-2], _number_in(words[-1])
        if tolerance is None:
            return None
    features: dict[str, float] = {}
    for word in words:
        name, equals, value = word.partition("=")
        number = _number_in(value)
        if not name or not equals or number is None:
            return None
        features[name] = number
    return PartialGoal(tuple(features.items()), tolerance or 0.0) if features else None


def _number_in(text: str) -> float | None:
    plain = text.removeprefix("-").replace(".", "", 1)
    return float(text) if plain.isdecimal() and len(text) <= _MOST_DIGITS else None
