"""A bench in simulated time: a simulated robot on a block, and an operator who does as asked."""

import itertools
import math
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Self

from hal.bus import CanBus, open_bus
from hal.codec import load_codec
from hal.control import Mode, SpeedControl, control_frame
from hal.kurt2 import Kurt2
from hal.kurt2_settings import Kurt2SensorSettings, Kurt2Settings, load_kurt2
from kurt2rt.checks.commission.checklist import STEPS, WORDS, Checklist, step_named
from kurt2rt.checks.commission.fault import SkipCode, StepFault
from kurt2rt.checks.commission.listener import Listener
from kurt2rt.checks.commission.operator import LEAVE, SKIP, AbortedError, OperatorQuestion, QuestionKind, Tone
from kurt2rt.checks.commission.progress import Progress, StepOutcome
from kurt2rt.checks.commission.step import CommissionStep
from kurt2rt.checks.commission.test_stand import TestStand
from kurt2rt.platform.clock import LockstepClock
from simbridge.simulated_robot import SimulatedKurt2
from simbridge.worlds.obstacle_settings import RoundObstacleSettings
from simbridge.worlds.world_settings import StartPoseSettings, WorldSettings
from tests.checks.commission.wired_end import WiredEnd, Wiring

BASE = load_kurt2()
CODEC = load_codec()
TODAY = "2026-11-21 15:00"
_SIDE_M = 6.0
_PARKED_M = (0.5, 0.5)

_numbers = itertools.count()

Instead = Callable[[OperatorQuestion], str | None]


class Workshop:
    """Robot, room, hand and wheels as they really are. `true`: what the robot is; the checklist is given BASE."""

    def __init__(
        self, true: Kurt2Settings = BASE, wiring: Wiring | None = None, hand_radius_m: float = 0.05, spec: str = ""
    ) -> None:
        self.true = true
        self.wiring = wiring or Wiring()
        self.spec = spec or f"virtual:commission-test-{next(_numbers)}"
        self.robot_end = (
            open_bus(spec) if spec else CanBus(self.spec.partition(":")[2], lambda name: WiredEnd(name, self.wiring))
        )
        self.robot = SimulatedKurt2(true, _room(hand_radius_m), self.robot_end, seed=1)
        self.stranger: CanBus | None = None
        """Another node, which sends CONTROL as soon as a wheel turns, after `stranger_waits_s`."""
        self.stranger_waits_s = 0.0
        self._hand_m = _PARKED_M
        self._hand_radius_m = hand_radius_m
        self._peaks = [0.0, 0.0]

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.robot_end.shutdown()

    def step(self) -> None:
        self.robot.step()
        if self.stranger is not None and any(self.robot.wheel_speeds):
            self.stranger_waits_s -= self.true.cycle_s
        if self.stranger is not None and self.stranger_waits_s < 0.0:
            self.stranger.control_port().send(control_frame(SpeedControl(Mode.SPEED_CM, 0, 0)))
            self.stranger.shutdown()
            self.stranger = None
        for side, speed_m_s in enumerate(self.robot.wheel_speeds):
            if abs(speed_m_s) > abs(self._peaks[side]):
                self._peaks[side] = speed_m_s

    def take_peaks(self) -> tuple[float, float]:
        """Fastest speeds of the wheels since the last call, with their signs."""
        left, right = self._peaks
        self._peaks = [0.0, 0.0]
        return left, right

    def hold_before(self, sensor: str, distance_m: float) -> None:
        """Move the hand, or the end of a board, to a distance from a sensor's face."""
        self._hold(self._place(sensor), distance_m)

    def hold_between(self, sensor: str, neighbour: str, distance_m: float) -> None:
        """Move the hand to the middle before two sensors."""
        single_side, other = self._place(sensor), self._place(neighbour)
        middle = {"x_m": (single_side.x_m + other.x_m) / 2, "y_m": (single_side.y_m + other.y_m) / 2}
        self._hold(single_side.model_copy(update=middle), distance_m)

    def _place(self, sensor: str) -> Kurt2SensorSettings:
        return next(each for each in BASE.infrared.sensors if each.name == sensor)

    def _hold(self, place: Kurt2SensorSettings, distance_m: float) -> None:
        pose = self.robot.pose
        heading_rad = pose.heading_rad + math.radians(place.heading_deg)
        cos, sin = math.cos(pose.heading_rad), math.sin(pose.heading_rad)
        away_m = distance_m + self._hand_radius_m
        self._move_hand(
            pose.x_m + place.x_m * cos - place.y_m * sin + away_m * math.cos(heading_rad),
            pose.y_m + place.x_m * sin + place.y_m * cos + away_m * math.sin(heading_rad),
        )

    def take_away(self) -> None:
        self._move_hand(*_PARKED_M)

    def _move_hand(self, x_m: float, y_m: float) -> None:
        self.robot.world.move_wall("hand", x_m - self._hand_m[0], y_m - self._hand_m[1])
        self._hand_m = (x_m, y_m)


class SimulatedPerson:
    """Does and says what a careful person would; `instead` answers first where it does not return None."""

    def __init__(self, workshop: Workshop, instead: Instead = lambda _: None) -> None:
        self._workshop = workshop
        self._instead = instead
        self.asked: list[OperatorQuestion] = []
        self.told: list[tuple[Tone, str]] = []

    def tell(self, text: str, tone: Tone = Tone.PLAIN) -> None:
        self.told.append((tone, text))

    def lines(self, tone: Tone) -> list[str]:
        return [text for its, text in self.told if its is tone]

    async def answer(self, question: OperatorQuestion) -> str:
        tried = [each for each in self.asked if (each.about, each.subject) == (question.about, question.subject)]
        self.asked.append(question)
        assert len(self.asked) < 200, f"no answer gets past: {question.text}"
        instead = self._instead(question)
        if instead is not None:
            return instead
        return self._do(question, len(tried))

    def _do(self, question: OperatorQuestion, tried: int) -> str:
        workshop = self._workshop
        match question.about:
            case QuestionKind.LIFTED:
                workshop.robot.lifted = True
                return WORDS
            case QuestionKind.MOVE:
                workshop.take_peaks()
            case QuestionKind.SEEN:
                return _in_words(*workshop.take_peaks())
            case QuestionKind.CLEAR:
                workshop.take_away()
            case QuestionKind.UNTOUCHED:
                workshop.wiring.pressed = 0
            case QuestionKind.HAND:
                workshop.hold_before(question.subject, 0.15)
                if tried:
                    return SKIP
            case QuestionKind.BOARD:
                assert question.distance_m is not None
                workshop.hold_before(question.subject, question.distance_m)
            case QuestionKind.BUMPER:
                bits = {bumper.name: bit for bit, bumper in enumerate(BASE.bumpers)} | dict(workshop.wiring.bumper_bits)
                workshop.wiring.pressed = 1 << bits[question.subject]
                if tried:
                    return SKIP
            case _:
                pass
        return ""


class Session:
    """One session at a bench."""

    def __init__(self, workshop: Workshop, folder: Path, instead: Instead = lambda _: None) -> None:
        self.workshop = workshop
        self.person = SimulatedPerson(workshop, instead)
        self.path = folder / "robot.json"
        self.progress = Progress(name="tested", base="kurt2", bus="virtual:bench")

    def knows(self, **findings: object) -> None:
        """Add findings of an earlier session."""
        found = self.progress.findings.model_copy(update=findings)
        self.progress = self.progress.model_copy(update={"findings": found})

    async def run(self, *names: str, skipped: Sequence[str] = ()) -> Progress:
        """Run the named steps, or all if none is named; return the progress."""
        chosen: list[CommissionStep] = [step_named(name) for name in names] or list(STEPS)
        spec = self.workshop.spec
        with ExitStack() as ending:
            stand = ending.enter_context(
                TestStand(
                    BASE,
                    lambda settings: Kurt2(settings, open_bus(spec)),
                    Listener(open_bus(spec), CODEC),
                    LockstepClock(self.workshop.step),
                    self.person,
                    second_guard=False,
                )
            )
            checklist = Checklist(stand, self.progress, self.path, "anna", lambda: TODAY)
            try:
                await checklist.run(chosen, [step_named(name) for name in skipped])
            except AbortedError:
                self.person.tell("left")
            finally:
                self.progress = checklist.progress
        return self.progress

    def outcome(self, step: str) -> StepOutcome:
        return self.progress.steps[step].outcome

    def faults(self, step: str) -> tuple[StepFault, ...]:
        return self.progress.steps[step].faults

    def skipped(self, step: str) -> SkipCode | None:
        return self.progress.steps[step].skipped

    def measured(self, step: str) -> tuple[str, ...]:
        return self.progress.steps[step].measured


def with_channels(**channels: str) -> Kurt2Settings:
    """Return BASE with some sensors on other channels."""
    sensors = tuple(
        each.model_copy(update={"channel": channels.get(each.name, each.channel)}) for each in BASE.infrared.sensors
    )
    return BASE.model_copy(update={"infrared": BASE.infrared.model_copy(update={"sensors": sensors})})


def leaves_at(about: QuestionKind) -> Instead:
    """Return answers of an operator who leaves at a question."""
    return lambda question: LEAVE if question.about is about else None


def _in_words(left_m_s: float, right_m_s: float) -> str:
    ways = {side: speed for side, speed in (("left", left_m_s), ("right", right_m_s)) if abs(speed) > 0.03}
    if not ways:
        return "none"
    side = "both" if len(ways) == 2 else next(iter(ways))
    return f"{side} {'forward' if next(iter(ways.values())) > 0 else 'back'}"


def _room(hand_radius_m: float) -> WorldSettings:
    side_m = _SIDE_M
    return WorldSettings(
        name="workshop",
        size_m=(side_m, side_m),
        infrared_rays=1,
        outline=((0.0, 0.0), (side_m, 0.0), (side_m, side_m), (0.0, side_m), (0.0, 0.0)),
        round_obstacles=(
            RoundObstacleSettings(name="hand", x_m=_PARKED_M[0], y_m=_PARKED_M[1], radius_m=hand_radius_m),
        ),
        start_poses=(StartPoseSettings(x_m=side_m / 2, y_m=side_m / 2, heading_deg=0.0),),
    )
