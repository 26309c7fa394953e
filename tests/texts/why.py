"""Listings of the sentences of `kurt2rt why` and of the line that sums up a run."""

import math
from collections.abc import Iterator
from dataclasses import replace

from hal.robot import WheelSpeeds
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.rla.rla import MID
from kurt2rt.runs.explain.facts import ContactFacts, DecisionFacts, DoubtFacts, LessonFact, LevelFacts
from kurt2rt.runs.explain.reasons import format_reasons, headline
from kurt2rt.runs.explain.sentences import (
    format_held,
    format_mid_level,
    format_runner_up,
    format_stamp,
    format_teaching,
    format_usage,
)
from kurt2rt.runs.explain.timeline import Kind, Note, Stretch, Timeline, format_summary
from tests.runs.explain.helpers import facts, level, story, with_mid

NEAR = story(17, (1.0, 2.0), "forward", 4.0)
NEXT = story(5, (3.0, 2.0), "forward", 6.0)
ELSE = story(9, (9.0, 2.0), "back", 8.0)
FAR = replace(NEAR, distance=15.0)
WITHDRAWN = replace(NEAR, action="ask", asks=True)
TWIN = replace(story(30, NEAR.condition, "back", 4.0), value=0.5)
NOTHING = level((1.0, 6.0))
KNOWN = level((1.0, 6.0), NEAR, NEXT, ELSE)
OUTSIDE = level((1.0, 6.0), FAR)
CROWD = level((1.0, 6.0), replace(NEAR, leads=False), TWIN)
PLACE = replace(story(12, (5.0,), "turn_left", 3.0, 1.0), title="mid-level RLA 12")
NO_WAY = replace(level((1.0,), PLACE), driver=None, level=MID)
NOTHING_ABOVE = replace(level((1.0,)), level=MID)
LOST = replace(level((math.nan,), replace(PLACE, distance=math.inf)), driver=None, level=MID)
STOOD = WheelSpeeds(0, 0)
OBSTACLE = DoubtFacts(3.41, 2.8, "front left", "13 cm", "40 cm")
CONTACT = DoubtFacts(7.2, 7.0, contact=ContactFacts("forward", 0.2, "front left (s9)", 0.45))


def standing(cause: DecisionCause, basic: LevelFacts = KNOWN) -> DecisionFacts:
    """Return the facts of a robot that stands for a cause."""
    return replace(facts(replace(basic, driver=None), cause.value, None), decided=STOOD)


def asking_the_way(mid: LevelFacts) -> DecisionFacts:
    """Return the facts of a robot whose mid level asks."""
    return replace(with_mid(standing(DecisionCause.UNKNOWN), mid), asks_at=MID)


LED = facts(KNOWN, DecisionCause.TEACHER.value, "by hand")
STOPPED = standing(DecisionCause.STOPPED)
OF_CAUSE: dict[DecisionCause, DecisionFacts] = {
    DecisionCause.RLA: facts(KNOWN),
    DecisionCause.HELD: facts(replace(KNOWN, driver=ELSE), DecisionCause.HELD.value, "back"),
    DecisionCause.TEACHER: replace(LED, teacher="Ann"),
    DecisionCause.UNKNOWN: standing(DecisionCause.UNKNOWN, OUTSIDE),
    DecisionCause.BLIND: replace(standing(DecisionCause.BLIND), infrared_age_s=0.07),
    DecisionCause.STOPPED: replace(STOPPED, stopped=STARTED),
    DecisionCause.UNATTENDED: standing(DecisionCause.UNATTENDED),
    DecisionCause.UNSAVED: replace(standing(DecisionCause.UNSAVED), trouble="the disk is full"),
    DecisionCause.AT_GOAL: replace(standing(DecisionCause.AT_GOAL), plan_says="arrived at door"),
    DecisionCause.TOUCHES: replace(standing(DecisionCause.TOUCHES), granted=STOOD, reasons=("front bumper",)),
    DecisionCause.DOUBT: replace(standing(DecisionCause.DOUBT), doubt=OBSTACLE),
    DecisionCause.NO_WAY: replace(standing(DecisionCause.NO_WAY), plan_says="no way to door"),
    DecisionCause.LEARNER: facts(replace(KNOWN, nearest=None, driver=None), DecisionCause.LEARNER.value),
    DecisionCause.LEARNER_FAILED: replace(standing(DecisionCause.LEARNER_FAILED), trouble="k-nn: ValueError: empty"),
}
"""Facts of a decision by its cause."""


def reasons() -> Iterator[tuple[str, str]]:
    """Yield headline and reasons of each cause, of the robot's questions, and of alarms and small doubts."""
    for cause in DecisionCause:
        yield cause, _told(OF_CAUSE[cause])
    more: dict[str, DecisionFacts] = {
        "rla, of one condition": facts(replace(CROWD, driver=TWIN)),
        "rla, pushes": replace(facts(KNOWN), granted=STOOD, reasons=("rear bumper",)),
        "rla, passes over a guess": facts(replace(KNOWN, passed_over=replace(ELSE, distance=3.0))),
        "rla, passes over a withdrawn one": facts(replace(KNOWN, passed_over=replace(WITHDRAWN, distance=3.0))),
        "rla, doubts a little": replace(facts(KNOWN), doubt=DoubtFacts(1.25, 2.8)),
        "rla, meets an obstacle": replace(facts(KNOWN), doubt=CONTACT),
        "rla, usual doubt": replace(facts(KNOWN), doubt=DoubtFacts(0.9, 2.8)),
        "rla, sensor broken": replace(facts(KNOWN), broken_sensors=("front left edge (s15)",)),
        "rla, alarm": replace(facts(KNOWN), granted=STOOD, reasons=("bus lost",), latched=True),
        "unknown, nothing taught": standing(DecisionCause.UNKNOWN, NOTHING),
        "unknown, asks sooner": standing(DecisionCause.UNKNOWN, replace(OUTSIDE, radius_share=0.5)),
        "unknown, withdrawn": standing(DecisionCause.UNKNOWN, level((1.0, 6.0), WITHDRAWN)),
        "unknown, lost action": standing(DecisionCause.UNKNOWN),
        "unknown, to a learner": standing(DecisionCause.UNKNOWN, replace(KNOWN, nearest=None)),
        "unknown way": asking_the_way(NO_WAY),
        "unknown way, nothing taught": asking_the_way(NOTHING_ABOVE),
        "unknown way, lost": asking_the_way(LOST),
        "blind, never saw": replace(standing(DecisionCause.BLIND), infrared_age_s=math.inf),
    }
    for label, of in more.items():
        yield label, _told(of)


def own_actions() -> Iterator[tuple[str, str]]:
    """Yield what a stopped or led robot would do by itself."""
    for hindrances in (
        (DecisionCause.BLIND, DecisionCause.UNATTENDED),
        (DecisionCause.UNSAVED,),
        (DecisionCause.UNATTENDED, DecisionCause.AT_GOAL),
        (DecisionCause.AT_GOAL,),
        (DecisionCause.NO_WAY,),
        (),
    ):
        plan_says = OF_CAUSE[hindrances[-1]].plan_says if hindrances else ""
        hindered = replace(STOPPED, hindrances=tuple(each.value for each in hindrances), plan_says=plan_says)
        yield f"stopped; {', '.join(hindrances) or 'nothing else'}", format_reasons(hindered)[1]
    yield "stopped; of a learner", format_reasons(standing(DecisionCause.STOPPED, replace(KNOWN, nearest=None)))[1]
    yield "stopped; of one condition", format_reasons(standing(DecisionCause.STOPPED, CROWD))[1]
    for label, mid in (("nothing taught", NOTHING_ABOVE), ("unknown", NO_WAY), ("lost", LOST)):
        yield f"led; way, {label}", format_reasons(replace(with_mid(LED, mid), asks_at=MID))[1]
    for label, basic in (("nothing taught", NOTHING), ("unknown", OUTSIDE)):
        led = replace(LED, basic=basic, hindrances=(DecisionCause.UNATTENDED.value,))
        yield f"led; {label}", format_reasons(led)[1]


def sentences() -> Iterator[tuple[str, str]]:
    """Yield the sentences about other RLAs, the minimum time, the guard, the mid level, lessons and use."""
    yield "runner-up, none", " ".join(format_runner_up(level((1.0, 6.0), NEAR)))
    yield "runner-up, equal action", " ".join(format_runner_up(KNOWN))
    yield "held, free", format_held(facts(KNOWN))
    yield "held", format_held(replace(facts(KNOWN), kept="forward"))
    limited = replace(facts(KNOWN), granted=WheelSpeeds(0.1, 0.1), reasons=("slew limit",))
    for label, of in (
        ("unchanged", facts(KNOWN)),
        ("limited", limited),
        ("alarm", replace(limited, latched=True)),
        ("touches", OF_CAUSE[DecisionCause.TOUCHES]),
    ):
        yield f"guard, {label}", " | ".join(format_reasons(of)[1:])
    above = replace(level((0.0,), replace(PLACE, distance=1.0)), level=MID, words=("left", "straight", ""))
    commands = replace(with_mid(facts(KNOWN), above), plan_says="on the way to door")
    for label, of in (
        ("commands", commands),
        ("asks", with_mid(facts(KNOWN), replace(above, driver=None))),
        ("lost", with_mid(facts(KNOWN), LOST)),
    ):
        yield f"mid level, {label}", " ".join(format_mid_level(of))
    corrected = LessonFact("RLA 17 corrected: back instead of forward", "Bob", 2, 2000, "2026-11-22T04:00:00+00:00")
    undone = replace(corrected, text="RLA 17 corrected: spin", changes=False, undone=True)
    yield "taught, newest lesson undone", format_teaching(replace(NEAR, acts=(*NEAR.acts, corrected, undone)))
    yield "taught, unknown", format_teaching(replace(NEAR, acts=()))
    yield "stamp, unknown", format_stamp(replace(corrected, stamp=""))
    yield "used", format_usage(NEAR)
    yield "used, rewarded", format_usage(replace(NEAR, rewards=2, punishments=1, value=0.25))


def summaries() -> Iterator[tuple[str, str]]:
    """Yield the line that sums up a run."""
    yield "nothing", format_summary(Timeline((), (), (), 0, 0, 0))
    ends_s = {Kind.ASKS: (0.0, 0.2), Kind.DRIVES: (0.2, 1.7), Kind.LED: (1.7, 2.0), Kind.STANDS: (2.0, 2.5)}
    stretches = tuple(Stretch(kind, "", "", *ends_s[kind]) for kind in Kind)
    notes = tuple(Note(1.0, kind, "") for kind in ("lesson", "lesson", "saying", "alarm"))
    ordered = tuple(sorted(stretches, key=lambda stretch: stretch.from_s))
    yield "everything", format_summary(Timeline(ordered, notes, (), 250, 4, 3))


def _told(of: DecisionFacts) -> str:
    return " | ".join((headline(of), *format_reasons(of)))
