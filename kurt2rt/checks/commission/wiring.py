"""Wiring faults from commanded, observed and counted motions."""

from enum import IntEnum
from typing import NamedTuple

from kurt2rt.checks.commission.fault import FaultCode, StepFault


class WheelSide(IntEnum):
    """Left or right side of the robot, as the index of its sign in a `Motion`."""

    LEFT = 0
    RIGHT = 1

    @property
    def word(self) -> str:
        """Name of the side: left or right."""
        return self.name.lower()


class Motion(NamedTuple):
    """Motion of both sides: 1 forward, -1 back, 0 not."""

    left: int
    right: int

    @property
    def only(self) -> tuple[WheelSide, int] | None:
        """Turning side and its sign (1 forward, -1 back); None if no side or both turn."""
        if bool(self.left) == bool(self.right):
            return None
        return (WheelSide.LEFT, self.left) if self.left else (WheelSide.RIGHT, self.right)

    def __str__(self) -> str:
        ways = {1: "forward", -1: "back"}
        if self.left == self.right:
            return f"both {ways[self.left]}" if self.left else "none"
        return ", ".join(
            f"{side.word} {ways[sign]}" for side, sign in zip(WheelSide, (self.left, self.right), strict=True) if sign
        )


STILL = Motion(0, 0)


def single_side(side: WheelSide, sign: int) -> Motion:
    """Return the motion of one side alone; `sign`: 1 forward, -1 back."""
    return Motion(sign, 0) if side is WheelSide.LEFT else Motion(0, sign)


class WheelTrial(NamedTuple):
    """Motion of one side three times: as ordered, as seen by the operator, as counted by the encoders.

    Differences between them tell swapped, reversed and dead motors and encoders (`wiring_faults`).
    """

    ordered: Motion
    seen: Motion
    counted: Motion


def parse_seen(answer: str) -> Motion | None:
    """Return the motion that the operator's words name; None if they cannot be understood.

    Valid are none, or left, right or both with forward or back. Each word may be cut short.
    """
    words = answer.split()
    if not words:
        return None
    who = [each for each in ("left", "right", "both", "none") if each.startswith(words[0])]
    if who == ["none"] and len(words) == 1:
        return STILL
    if len(words) != 2:
        return None
    way = [sign for each, sign in (("forward", 1), ("back", -1), ("backward", -1)) if each.startswith(words[1])]
    if len(who) != 1 or not way:
        return None
    return {"left": Motion(way[0], 0), "right": Motion(0, way[0]), "both": Motion(way[0], way[0])}.get(who[0])


def wiring_faults(trials: list[WheelTrial]) -> list[StepFault]:
    """Return the faults, motors before encoders. `trials`: each side, both ways."""
    motors = [(trial.ordered, trial.seen) for trial in trials]
    encoders = [(trial.seen, trial.counted) for trial in trials]
    return _judge(motors, _MOTORS) + _judge(encoders, _ENCODERS)


class _Codes(NamedTuple):
    swapped: FaultCode
    reversed: FaultCode
    dead: FaultCode
    odd: FaultCode


_MOTORS = _Codes(FaultCode.MOTORS_SWAPPED, FaultCode.MOTOR_REVERSED, FaultCode.MOTOR_DEAD, FaultCode.MOTOR_ODD)
_ENCODERS = _Codes(
    FaultCode.ENCODERS_SWAPPED, FaultCode.ENCODER_REVERSED, FaultCode.ENCODER_DEAD, FaultCode.ENCODER_ODD
)


def _judge(pairs: list[tuple[Motion, Motion]], codes: _Codes) -> list[StepFault]:
    """Return the faults from causes of one side and their effects."""
    effects = {side: _effect_of(side, pairs) for side in WheelSide}
    swapped = all(effect is not None and effect[0] is not side for side, effect in effects.items())
    found = [StepFault(codes.swapped)] if swapped else []
    for side in WheelSide:
        causes = [effect for cause, effect in pairs if cause.only is not None and cause.only[0] is side]
        effect = effects[side]
        if not causes:
            continue
        if all(each == STILL for each in causes):
            found.append(StepFault.of(codes.dead, side=side.word))
        elif effect is None or (effect[0] is not side and not swapped):
            motion = " and ".join(dict.fromkeys(str(each) for each in causes))
            found.append(StepFault.of(codes.odd, side=side.word, motion=motion))
        elif effect[1] < 0:
            # The part that turned is the one to mend, wherever its plug is.
            found.append(StepFault.of(codes.reversed, side=effect[0].word))
    return found


def _effect_of(side: WheelSide, pairs: list[tuple[Motion, Motion]]) -> tuple[WheelSide, int] | None:
    """Return the side that answers to a side, and 1 or -1 for its direction; None unless it is unique."""
    answers = set()
    for cause, effect in pairs:
        if cause.only is None or cause.only[0] is not side:
            continue
        if effect.only is None:
            return None
        answers.add((effect.only[0], effect.only[1] * cause.only[1]))
    return answers.pop() if len(answers) == 1 else None
