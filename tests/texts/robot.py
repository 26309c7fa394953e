"""Listings of the robot's own words, the same on every surface: questions, goals, lessons and features."""

from collections.abc import Iterator
from dataclasses import replace

from hal.robot_settings import load_robot
from kurt2rt.core.decision.decision import GoalStatus
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal, goal_text
from kurt2rt.core.perception.sensor_words import NO_WORDS, words_for
from kurt2rt.core.planning.goal_pursuit import GoalPursuit
from kurt2rt.core.planning.topological_map import Edge
from kurt2rt.core.rla.events import Appraised, Lesson, LessonRedone, TeachingEvent
from kurt2rt.core.rla.lesson_history import LessonRecord, hold_text
from kurt2rt.core.rla.rla import ASK, CRITIC, MID
from kurt2rt.core.teaching.question import FeatureDifference, MidQuestion, Question
from kurt2rt.runs.explain.timeline import LessonDescriber
from tests.core.planning.town import Town
from tests.core.rla.helpers import created, deleted, named, origin, replaced, rewarded, session, undone, withdrawn

WORDS = words_for(load_robot().infrared)
DIFFERING = (
    FeatureDifference("s9", 441.0, 108.0),
    FeatureDifference("s14", 70.0, 400.0),
    FeatureDifference("maximum front", 505.0, 500.0),
    FeatureDifference("orientation left s1>s2", 42.0, 0.0),
    FeatureDifference("s9 (10 s average)", 72.0, 70.0),
)
"""The nearest in front and the average differ by less than a centimetre, so no text in words names them."""


def questions() -> Iterator[tuple[str, str]]:
    """Yield the questions of the basic level and of the mid level."""
    outside = Question(1, "curve_left", 500.4, 300.0, DIFFERING)
    inside = replace(outside, distance=120.0, differing=DIFFERING[:2])
    nothing = Question(None, None, float("inf"), 0.0, ())
    blamed = replace(inside, action=ASK)
    asked: dict[str, Question] = {
        "unknown": outside,
        "unknown, in words": replace(outside, words=WORDS),
        "unknown, of a behaviour": replace(outside, behaviour="turn_left", differing=()),
        "unknown, nearest withdrawn": replace(outside, action=ASK, differing=()),
        "nothing taught": nothing,
        "nothing taught, of a behaviour": replace(nothing, behaviour="turn_left"),
        "withdrawn": blamed,
        "withdrawn, value known": replace(blamed, worth=-0.3),
        "lost action": inside,
        "doubts": replace(inside, doubts=True),
        "doubts, in words": replace(inside, doubts=True, words=WORDS),
        "touches": replace(inside, touches="<a question of standing>"),
    }
    for label, question in asked.items():
        yield label, str(question)
    junctions = ("straight", "left")
    way = MidQuestion(1, "turn_left", 2.0, 1.0, junctions)
    asked_the_way: dict[str, MidQuestion] = {
        "way unknown": way,
        "way unknown, nearest withdrawn": replace(way, behaviour=ASK, here=()),
        "no way taught": MidQuestion(None, None, float("inf"), 0.0, junctions),
        "no way taught, at the beginning": MidQuestion(None, None, float("inf"), 0.0, ()),
        "location unknown": replace(way, distance=float("inf")),
    }
    for label, of_the_way in asked_the_way.items():
        yield label, str(of_the_way)


def goals() -> Iterator[tuple[str, str]]:
    """Yield the kinds of goals, each status without a plan, and the progress on a plan."""
    yield "named", NamedGoal("door").text
    yield "of an RLA", RlaGoal(1).text
    yield "partial", PartialGoal((("x_m", 0.0), ("wall_left", 0.5))).text
    for status in GoalStatus:
        if status is not GoalStatus.NONE:
            yield status, goal_text(status, "door")
    for ways in (1, 3):
        pursuit = _pursuit(GoalStatus.UNDER_WAY)
        pursuit.plan = tuple(Edge(rla_id, "turn_left", 0, 1, 1.0, 9.0) for rla_id in range(4, 4 + ways))
        yield f"{GoalStatus.UNDER_WAY}, ways: {ways}", pursuit.text
    given_up = _pursuit(GoalStatus.UNDER_WAY)
    given_up.give_up("<a refusal>")
    yield f"{GoalStatus.NO_WAY}, given up", given_up.text


def _pursuit(status: GoalStatus) -> GoalPursuit:
    pursuit = GoalPursuit(Town().build_map, lambda _: ())
    pursuit.goal, pursuit.status = NamedGoal("door"), status
    return pursuit


def lessons() -> Iterator[tuple[str, str]]:
    """Yield the description of each lesson, and of events in a timeline."""
    condition = (0.0, 0.0)
    taught = created(1, condition)
    of_lessons: dict[str, Lesson] = {
        "taught": taught,
        "corrected": replaced(1, "back", "forward"),
        "withdrawn": withdrawn(1),
        "answered again": replaced(1, "back", ASK),
        "deleted": deleted(1),
        "rewarded": rewarded(1),
        "punished": rewarded(1, -1),
        "named": named("door", condition),
    }
    for label, event in of_lessons.items():
        yield label, LessonRecord(event).text
    yield "taught, of a behaviour", LessonRecord(taught, behaviour="turn_left").text
    for level in (MID, CRITIC):
        yield f"taught, {level}", LessonRecord(taught, level=level).text
    yield "held", hold_text([LessonRecord(taught)])
    yield "held, two", hold_text([LessonRecord(taught), LessonRecord(replaced(1, "back", "forward"))])
    describer = LessonDescriber()
    begun, ended = session(30)
    told: dict[str, TeachingEvent] = {
        "taught": created(2, condition, behaviour="turn_left"),
        "corrected": replaced(2, "back", "forward", "a"),
        "undone": undone("a"),
        "redone": LessonRedone("a", origin("redo-a")),
        "undone, unknown": undone("b"),
        "named": named("door", condition),
        "begun": begun,
        "ended": ended,
        "appraised": Appraised("bad", -1, 9, origin("signal-1")),
    }
    for label, each in told.items():
        yield f"timeline, {label}", describer.describe(each)


def features() -> Iterator[tuple[str, str]]:
    """Yield places and values of features."""
    for feature in (
        *("s9", "s9 (10 s average)", "maximum front", "minimum rear (10 s average)", "orientation left s2>s1"),
        *("wheel speed left", "junction"),
    ):
        yield feature, WORDS.place(feature)
    for counts in (0, 70, 441, 1023):
        yield f"{counts} counts", WORDS.reading("maximum front", counts)
    for counts in (0, 42):
        yield f"orientation, {counts} counts", WORDS.reading("orientation left s2>s1", counts)
    yield "difference", WORDS.difference("s9", 441.0, 108.0)
    yield "difference of numbers", WORDS.difference("wheel speed left", 30.0, 0.25)
    yield "difference without words", NO_WORDS.difference("maximum front", 300.0, 20.0)
