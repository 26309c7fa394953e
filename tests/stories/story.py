"""A story: one robot, world, teacher and what goes wrong, told by a seed; and as a file of some lines."""

import random
from pathlib import Path
from typing import Literal, get_args

import yaml

from config.settings import Settings, load_settings
from hal.points import Point
from tests.stories.table import TABLE, Fault, Kind, RobotKind, Target

CALM_S = 6.0
"""Time at the end in which nothing fails any more, and the teacher is there."""
FIRST_S = 1.0
MOST_FAULTS = 12
_ROBOTS: tuple[RobotKind, ...] = ("kurt2", "kurt2", "kurt2", "school", "turtlebot")
_GAP_S = 0.5
"""Least time between two faults of one target."""


class Teaching(Settings):
    """Teacher of a story: phase, time of a reaction in s, share of wrong answers, and whether a finger stays down."""

    phase: int = 2
    reaction_s: float = 0.5
    error_rate: float = 0.0
    by: Literal["press", "hold"] = "press"


class Event(Settings):
    """Fault of a story, in s from its beginning."""

    at_s: float
    target: Target
    kind: Kind
    lasts_s: float

    def fault(self) -> Fault:
        return TABLE.fault(self.target, self.kind, self.at_s, self.at_s + self.lasts_s)


class Story(Settings):
    """All that a story is made of; equal stories end equal."""

    seed: int
    """Seed of all that chance decides: body and sensors, noise, phases, frames that are lost."""
    lasts_s: float
    robot: RobotKind = "kurt2"
    world: str = "a"
    task: str = "wall_following"
    taught: bool = False
    """True if the robot knows something at the beginning."""
    records: bool = False
    """True if it is recorded, and replayed in the end."""
    points: tuple[Point, ...] = ()
    """Points of the program at which something happens now and then."""
    teaching: Teaching = Teaching()
    faults: tuple[Event, ...] = ()

    def named(self, name: str) -> str:
        """Return the name of one of the robot's worlds or tasks, as its plug-in has it."""
        return name if self.robot == "kurt2" else f"{self.robot}/{name}"

    @property
    def over_s(self) -> float:
        """Time from which on nothing fails."""
        return max((each.at_s + each.lasts_s for each in self.faults), default=0.0)


def all_kinds() -> list[tuple[Target, Kind]]:
    """Return each kind of fault of each target."""
    return [(target, kind) for rows in (TABLE.cases, TABLE.stories) for target, kinds in rows.items() for kind in kinds]


def story_of(seed: int, lasts_s: float) -> Story:
    """Return the story of a seed. It leaves out half of the kinds, so that some of the others meet often.

    Half of the faults are of parts that the robot has alone.
    """
    chance = random.Random(f"story {seed}")
    robot = chance.choice(_ROBOTS)
    kinds = sorted(each for each in all_kinds() if TABLE.has(robot, each[0]))
    kinds = chance.sample(kinds, len(kinds) // 2)
    own = [each for each in kinds if each[0] in TABLE.parts[robot]]
    parts = [each for each in (own, sorted({*kinds} - {*own})) if each]
    faults: list[Event] = []
    busy: dict[Target, list[tuple[float, float]]] = {}
    for _ in range(chance.randint(0, MOST_FAULTS)):
        target, kind = chance.choice(chance.choice(parts))
        lasts = chance.uniform(*TABLE.row(target, kind).lasts_s)
        lasts = round(min(lasts, (lasts_s - CALM_S - FIRST_S) / 2), 3)
        at = round(chance.uniform(FIRST_S, lasts_s - CALM_S - lasts), 3)
        spans = busy.setdefault(target, [])
        if all(at + lasts + _GAP_S < begin or at > end + _GAP_S for begin, end in spans):
            spans.append((at, at + lasts))
            faults.append(Event(at_s=at, target=target, kind=kind, lasts_s=lasts))
    return Story(
        seed=seed,
        lasts_s=lasts_s,
        robot=robot,
        world=chance.choice(("a", "a", "b", "c")),
        task=chance.choice(("wall_following", "fleeing")),
        taught=chance.random() < 0.5,
        records=chance.random() < 0.1,
        points=tuple(sorted(chance.sample(get_args(Point), chance.randint(0, len(get_args(Point)) // 2)))),
        teaching=Teaching(
            phase=chance.choice((1, 2, 2, 3, 4, 5)),
            reaction_s=round(chance.uniform(0.2, 2.0), 2),
            error_rate=chance.choice((0.0, 0.05, 0.2)),
            by=chance.choice(("press", "hold")),
        ),
        faults=tuple(sorted(faults, key=lambda each: each.at_s)),
    )


def load_story(path: Path) -> Story:
    """Return the story of a file. Raises config.settings.SettingsError."""
    return load_settings(path, Story)


def as_text(story: Story) -> str:
    """Return a story as a file, a line for each fault."""
    plain = story.model_dump(mode="json")
    faults = plain.pop("faults")
    lines = "".join(f"- {yaml.safe_dump(each, default_flow_style=True, width=1000)}" for each in faults)
    return yaml.safe_dump(plain, sort_keys=False) + (f"faults:\n{lines}" if faults else "")
