"""The mid level in the picture: a map of places, or the last symbols; and whom an RLA is compared with."""

import math
import re
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.counterfactual import SensorCounterfactual
from kurt2rt.runs.explain.facts import DecisionFacts, LevelFacts, RlaFacts
from kurt2rt.runs.explain.picture import draw_why
from tests.runs.explain.helpers import ROBOT, Lesson, level, story, with_mid
from tests.teacher.helpers import teach

PLACES = ("x_m", "y_m", "east", "north", "wall_left", "wall_right")


@dataclass(frozen=True)
class Now:
    """Facts and counterfactuals of a robot's newest decision."""

    facts: DecisionFacts
    counterfactuals: tuple[SensorCounterfactual, ...]


@pytest.fixture(scope="module")
def now() -> Now:
    lesson = Lesson()
    lesson.go_on(5)
    lesson.go_on(5, teach("forward"))
    now = Now(lesson.facts, lesson.counterfactuals)
    lesson.close()
    return now


def titled(rla_id: int, condition: tuple[float, ...], action: str, distance: float, radius: float) -> RlaFacts:
    return replace(story(rla_id, condition, action, distance, radius), title=f"mid-level RLA {rla_id}")


def drawn(now: Now, mid: LevelFacts, path: Path, *, asks: bool = False) -> str:
    facts = with_mid(now.facts, mid)
    if asks:
        facts = replace(facts, cause="unknown", action=None, asks_at=MID)
    draw_why(facts, now.counterfactuals, ROBOT, "a title", path)
    return path.read_text(encoding="utf-8")


def test_places_are_a_map_with_the_robot_in_it(now: Now, tmp_path: Path) -> None:
    near = titled(12, (0.0, 0.0, 1.0, 0.0, 0.0, 1.0), "turn_left", 0.2, 0.85)
    far = titled(15, (2.0, 0.0, 0.0, 1.0, 1.0, 1.0), "straight_on", 2.1, 0.85)
    mid = replace(level((0.1, 0.1, 1.0, 0.0, 0.5, 0.5), near, far), names=PLACES, level=MID)
    text = drawn(now, mid, tmp_path / "places.svg")
    assert "mid-level RLA 12 at 0.2 m, R 0.85 m" in text
    assert "to RLA 1" in text


def test_a_robot_that_is_lost_is_not_on_the_map(now: Now, tmp_path: Path) -> None:
    near = titled(12, (0.0, 0.0, 1.0, 0.0, 0.0, 1.0), "turn_left", math.inf, 0.85)
    mid = replace(level((math.nan, math.nan, 1.0, 0.0, 0.5, 0.5), near), names=PLACES, level=MID, driver=None)
    text = drawn(now, mid, tmp_path / "lost.svg", asks=True)
    assert "lost" in text
    assert "places" in text
    assert "star: here" not in text


def test_histories_stand_below_each_other(now: Now, tmp_path: Path) -> None:
    nearest = titled(12, (1.0, 0.0, 2.0), "turn_left", 2.0, 1.0)
    mid = replace(
        level((1.0, 2.0, -1.0), nearest),
        level=MID,
        euclidean=False,
        driver=None,
        words=("left", "right", ""),
        nearest_words=("left", "straight", "right"),
    )
    text = drawn(now, mid, tmp_path / "history.svg", asks=True)
    assert re.search(r"\b2 .*, R 1\b", text)
    assert "mid-level RLA 12" in text


def test_contrast_of_the_nearest_is_the_next_with_another_action() -> None:
    nearest, same, other = story(1, (1.0,), "back", 1), story(2, (2.0,), "back", 2), story(3, (3.0,), "stand", 3)
    assert level((0.0,), nearest, same, other).contrast_of(nearest) is other
    assert level((0.0,), nearest, same).contrast_of(nearest) is same
    assert level((0.0,), nearest).contrast_of(nearest) is None
    assert level((0.0,), nearest, same, other).contrast_of(other) is nearest
