"""The whole idea in one file: sense, look for the nearest rule, ask, be taught, drive.

    python docs/examples/mini.py

A simulated robot stands in a room and asks. Type what it should do; each answer is a rule, and the nearest rule
drives. Teach it to follow the wall on its left. Nothing of the runtime is used here, only the simulated robot; a test
(tests/test_mini.py) holds that this mind decides as the real one does, tick by tick.

Left out, and found in the runtime: undo, storage, explanations, rewards and the critic, junctions and goals.
"""

import select
import sys
import termios
import time
import tty
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import count

import numpy as np
from numpy.typing import NDArray

from hal.kurt2_settings import load_kurt2
from hal.robot import WheelSpeeds
from hal.robot_settings import InfraredSettings
from simbridge.simulation import Kurt2SimulationFactory

Vector = NDArray[np.float64]

TICK_S = 0.01
"""The robot decides 100 times a second."""
HISTORY = 1000
"""Ticks of the averages: ten seconds."""
RADIUS = 900.0
"""R in counts: beyond it a rule says nothing, and the robot stops and asks (paper, section III)."""
ASKS_BEYOND = 0.55
"""Share of R beyond which it asks already while a teacher is there."""
REPLACES_WITHIN = 0.02
"""Share of R within which a correction changes the nearest rule; farther away it makes a rule of its own."""
LEAST_TICKS = 10
"""An action drives for a tenth of a second at least, so that two rules do not make the robot tremble."""

ACTIONS = {
    "forward": WheelSpeeds(0.30, 0.30),
    "bear_left": WheelSpeeds(0.25, 0.32),
    "bear_right": WheelSpeeds(0.32, 0.25),
    "curve_left": WheelSpeeds(0.12, 0.32),
    "curve_right": WheelSpeeds(0.32, 0.12),
    "spin_left": WheelSpeeds(-0.20, 0.20),
    "spin_right": WheelSpeeds(0.20, -0.20),
    "back": WheelSpeeds(-0.15, -0.15),
    "stand": WheelSpeeds(0.0, 0.0),
}
KEYS = dict(zip("wqeadjlxs", ACTIONS, strict=True))

HEADINGS = {"front": (9, 10, 11), "left": (1, 2, 3, 4), "right": (5, 6, 7, 8), "rear": (12, 13, 14)}
"""Numbers of the infra-red sensors that look each way. A high count is a near obstacle."""
SLANTS = {"left": (1, 2), "right": (5, 6), "front": (9, 10), "rear": (12, 13)}
"""Two sensors of each side whose difference tells how the robot stands to a wall."""


def features(counts: Sequence[int]) -> list[int]:
    """Return 36 features of the 18 sensors' counts (paper, section VI.B.1); the last two are not used here."""
    sensor = dict(enumerate(counts, start=1))
    values = list(counts)
    for numbers in HEADINGS.values():
        seen = [sensor[number] for number in numbers]
        values += [max(seen), min(seen)]
    for one, other in SLANTS.values():
        difference = sensor[one] - sensor[other]
        values += [max(difference, 0), max(-difference, 0)]
    return [*values, 0, 0]


def weights() -> Vector:
    """Return the weight of each feature, shape (72,), to follow a wall on the left; the averages count nothing."""
    weight = np.ones(36)
    weight[14] = 1.5  # sensor 15 alone sees a corner ahead to the left
    weight[18], weight[19] = 2.0, 0.0  # the nearest obstacle in front, not the farthest
    weight[[4, 5, 6, 7, 11, 12, 13, 16, 17, *range(22, 26), 28, 29, 32, 33]] = 0.5  # right and rear
    return np.concatenate([weight, np.zeros(36)])


class Senses:
    """The situation: 36 features now, and the same averaged over the last 1000 ticks, in a ring buffer."""

    def __init__(self) -> None:
        self._ring = np.zeros((HISTORY, 36))
        self._begun = False
        self._next = 0

    def situation(self, counts: Sequence[int], *, waits: bool) -> Vector:
        """Return the situation, shape (72,), in counts; while the robot waits, the averages stay as they are."""
        now = np.array(features(counts), dtype=float)
        if not self._begun:
            self._ring[:], self._begun = now, True  # as if it had always been here
        if not waits:
            self._ring[self._next % HISTORY] = now
            self._next += 1
        return np.concatenate([now, self._ring.mean(axis=0)])


@dataclass
class Rule:
    """An RLA without its expectation: in situations like this one, do that."""

    number: int
    condition: Vector
    action: str


@dataclass(frozen=True)
class Decision:
    """An action and the rule that named it; without a rule the robot stands and asks."""

    action: str
    rule: int | None
    distance: float


class Mind:
    """All rules. The nearest one within the radius drives; beyond it the robot does not know."""

    def __init__(self, *, taught: bool = True) -> None:
        """`taught`: whether a teacher is there, so that the robot asks sooner."""
        self.rules: list[Rule] = []
        self._weights = weights()
        self._radius = RADIUS * (ASKS_BEYOND if taught else 1.0)
        self._driver: Rule | None = None
        self._drives = ""
        self._ticks = 0

    def nearest(self, situation: Vector) -> tuple[Rule | None, float]:
        """Return the rule nearest to a situation (72,), and its distance in counts; of equal ones the oldest."""
        if not self.rules:
            return None, float("inf")
        off = (np.array([rule.condition for rule in self.rules]) - situation) * self._weights
        distances = np.sqrt(np.square(off).sum(axis=1))
        place = int(distances.argmin())
        return self.rules[place], float(distances[place])

    def decide(self, situation: Vector) -> Decision:
        """Return the decision for this tick's situation, shape (72,)."""
        rule, distance = self.nearest(situation)
        if rule is None or distance > self._radius:
            self._driver, self._drives = None, ""
            return Decision("stand", None, distance)
        if rule.action == self._drives or self._ticks >= LEAST_TICKS or self._driver is None:
            if rule.action != self._drives:
                self._drives, self._ticks = rule.action, 0
            self._driver = rule
        self._ticks += 1
        return Decision(self._drives, self._driver.number, distance)

    def teach(self, situation: Vector, action: str, *, corrects: bool) -> Rule:
        """Make an action the answer to a situation (72,); return the new or changed rule. It acts on the next tick.

        `corrects`: the robot knew the situation and did something else; an answer to its question is a new rule.
        """
        rule, distance = self.nearest(situation)
        self._ticks = LEAST_TICKS
        if corrects and rule is not None and distance <= REPLACES_WITHIN * RADIUS:
            rule.action = action
            return rule
        rule = Rule(len(self.rules) + 1, situation, action)
        self.rules.append(rule)
        return rule


def seen(counts: Sequence[int], law: InfraredSettings) -> str:
    """Return what the robot sees on each side: the distance of the nearest obstacle in cm, up to 60."""
    nearest = {side: max(counts[number - 1] for number in numbers) for side, numbers in HEADINGS.items()}
    return ", ".join(f"{side} {100 * min(law.distance_m(near), 0.6):.0f} cm" for side, near in nearest.items())


@contextmanager
def keyboard() -> Iterator[None]:
    """Let single keys through, without Enter."""
    before = termios.tcgetattr(sys.stdin)
    tty.setcbreak(sys.stdin)
    try:
        yield
    finally:
        termios.tcsetattr(sys.stdin, termios.TCSADRAIN, before)


def key(*, wait: bool) -> str:
    """Return the key that was pressed, or nothing; `wait`: until there is one."""
    ready, _, _ = select.select([sys.stdin], [], [], None if wait else 0)
    return sys.stdin.read(1) if ready else ""


def main() -> None:
    """Drive the simulated robot and be its teacher, until Ctrl-C."""
    print("keys: " + ", ".join(f"{letter} {action}" for letter, action in KEYS.items()) + "; Ctrl-C ends")
    mind, senses, waits, bumps = Mind(), Senses(), True, 0
    robot = load_kurt2()
    factory = Kurt2SimulationFactory(robot)
    with closing(factory.open("a", 1, "mini")) as simulation, keyboard():
        for tick in count(1):
            simulation.step()
            if simulation.collisions > bumps:
                bumps = simulation.collisions
                print(f"\n{tick * TICK_S:6.2f} s  bump", end="", flush=True)
            readings = simulation.robot.sense(tick * TICK_S)
            if readings.infrared_age_s > 1:  # before the first reading
                continue
            situation = senses.situation(readings.infrared_counts, waits=waits)
            decision = mind.decide(situation)
            waits = decision.rule is None
            if waits:
                sees = seen(readings.infrared_counts, robot.infrared)
                print(f"\n{tick * TICK_S:6.2f} s  {sees}: I do not know this. ", end="", flush=True)
            # The world stands still while it waits for an answer.
            action = KEYS.get(key(wait=waits))
            if action is not None and action != decision.action:
                rule = mind.teach(situation, action, corrects=not waits)
                print(f"\n{tick * TICK_S:6.2f} s  rule {rule.number}: {action}", end="", flush=True)
                decision = mind.decide(situation)
                waits = False
            simulation.robot.drive(ACTIONS[decision.action], tick * TICK_S, tick * TICK_S)
            time.sleep(TICK_S)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        print()
