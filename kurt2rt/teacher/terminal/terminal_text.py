"""Texts of the teacher's terminal."""

import math
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from typing import get_args

from kurt2rt.channel.protocol.hello import AppraisalName, Hello, MidIntroduction
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.requests import CommandRequest, ExportRequest, SaveRequest
from kurt2rt.channel.protocol.state import MidState, State, SurpriseState
from kurt2rt.core.critic.critic import CriticState
from kurt2rt.core.decision.decision import DecisionCause, StandReason
from kurt2rt.core.decision.standing import GO_IN_TERMINAL, question_text, standing_headline
from kurt2rt.core.outcome_text import neighbours_text
from kurt2rt.core.perception.sensor_words import NO_WORDS, SensorWords
from kurt2rt.core.rla.rla import ASK, MID, rla_title
from kurt2rt.core.teaching.commands import Resume, Single
from kurt2rt.core.teaching.question import FeatureDifference, MidQuestion, Question

HISTORY = "history"
LOUD_FROM = 4.0
"""Ratio of a surprise to the usual distance from which on it is printed; the page emphasises it from there on."""

_HELP = """\
an action                answers the robot's question, or corrects what it does
(just Enter), stop       the robot stands until you type go; it overtakes all other commands
step ACTION [SECONDS]    one action for half a second, or as long as you say; teaches nothing
hold ACTION SECONDS      does the action, and is taught it in the situations on the way; then it drives on
rewind SECONDS ACTION    corrects what it did that long before it stopped (up to 60 s)
+, -                     reward or punish the action that drives
why                      explain what it does now
lessons                  show the last ten lessons
health                   late ticks, sensors, bus, disk; faults and their cures
help, quit"""
_PURSUE_HELP = "pursue NAME              follow another taught behaviour; lessons are about the one that is followed"
KINDS: Mapping[str, type[Single | CommandRequest]] = {
    **{kind.path.split("/")[-1]: kind for kind in (*get_args(Single), SaveRequest, ExportRequest)},
    "go": Resume,
}
"""Class of each command by its word, the end of its path on the wire; its fields follow in their order."""

_PLAIN_HELP = "\n".join(f"{kind.typed[0]:<24} {kind.typed[1]}" for kind in dict.fromkeys(KINDS.values()) if kind.typed)
_CRITIC_HELP = """\
an appraisal             teaches the critic the value of this situation (phase 4)
critic                   its opinion, its agreement with you, its last change"""

_MID_HELP = """\
a behaviour              answers which way is right here, or corrects the mid level
also NAME                this behaviour is possible here, too
pursue NAME              only this once, until it has finished; teaches nothing
way                      the choice of the mid level, its reason, and the last junctions"""
_GOAL_HELP = """\
name NAME, places        give the mid level's situation a name; show those that have one
seek NAME, seek rla N    go there, by what was taught; seek FEATURE=VALUE ... [within T] for any such place
seek, here NAME          end the search; tell the robot that it is there"""


def help_lines(hello: Hello) -> tuple[str, ...]:
    """Return the help for the commands of this robot."""
    more = [_CRITIC_HELP] if hello.appraisals else []
    if hello.mid is not None:
        more.append(_MID_HELP)
    elif len(hello.behaviours) > 1:
        more.append(_PURSUE_HELP)
    more += [_GOAL_HELP] if hello.seeks else []
    return (_HELP, _PLAIN_HELP, *more, *name_lines(hello))


def name_lines(hello: Hello) -> tuple[str, ...]:
    """Return the names of the robot's actions, appraisals and behaviours."""
    lines = [f"actions: {', '.join(hello.actions)}"]
    if hello.appraisals:
        lines.append(f"appraisals: {', '.join(each.name for each in hello.appraisals)}")
    if len(hello.behaviours) > 1:
        lines.append(f"taught behaviours: {', '.join(hello.behaviours)}")
    return tuple(lines)


def format_misunderstood(words: Sequence[str], hello: Hello) -> str:
    """Return what is wrong with a typed line that is no command of this robot, and what may be meant.

    `words`: of the line, at least one.
    """
    names = (*hello.actions, *(each.name for each in hello.appraisals), *hello.behaviours)
    lines = [line for part in help_lines(hello) for line in part.splitlines() if "  " in line]
    forms = [form for line in lines for form in line.split("  ")[0].split(", ")]
    usages = {form.split()[0]: form for form in forms if form.split()[0] not in ("an", "a", "(just")}
    usage = usages.get(words[0])
    wrong = words[0] if usage is None else next((each for each in words[1:] if each[0].isalpha()), "")
    near = get_close_matches(wrong, names if usage else (*names, *usages), n=3) if wrong not in names else []
    says = f"{words[0]}: no such command or action" if usage is None else f"{' '.join(words)}: type {usage}"
    maybe = f"; did you mean {' or '.join(near)}?" if near else ""
    return f"not done, {says}{maybe or ('; help shows what can be typed' if usage is None else '')}"


def build_question(state: State, words: SensorWords = NO_WORDS) -> Question | MidQuestion:
    """Return the question of a state, in the robot's `words` for its sensors."""
    if state.asks_at == MID and state.mid is not None:
        mid = state.mid
        came_by = tuple(word for word in mid.here if word)
        return MidQuestion(mid.nearest, mid.nearest_behaviour, mid.distance, mid.radius, came_by)
    differing = tuple(FeatureDifference(each.name, each.here, each.in_condition) for each in state.question)
    return Question(
        nearest_rla=state.nearest,
        action=state.nearest_action,
        distance=state.distance,
        radius=state.radius,
        differing=differing,
        behaviour=state.behaviour,
        words=words,
        worth=state.nearest_value,
        touches=question_text(state.standing),
        doubts=state.cause == DecisionCause.DOUBT,
        image=state.nearest_image,
    )


def expects_answer(state: State | None) -> bool:
    """Return whether a typed action answers; otherwise it corrects the nearest RLA of the basic level."""
    if state is None:
        return True
    if state.asks_at == MID:
        return False  # the nearest RLA of the state is the mid level's
    doubts = state.cause == DecisionCause.DOUBT
    return doubts or state.nearest is None or state.nearest_action == ASK or state.distance > state.radius


def expects_mid_answer(mid: MidState) -> bool:
    """Return whether a typed behaviour answers the mid level; otherwise it corrects the nearest RLA."""
    return mid.nearest is None or mid.nearest_behaviour == ASK or mid.distance > mid.radius


def format_mid_command(state: State, introduced: MidIntroduction) -> str:
    """Return the choice of the mid level and its reason; empty while it asks, or without a mid level."""
    mid = state.mid
    if mid is None or mid.asks:
        return ""
    if mid.overridden:
        return f"{mid.behaviour}, because a teacher said so, until it has finished"
    if mid.rla is None:
        return f"{mid.behaviour}; the mid level has not said anything yet"
    if introduced.kind == HISTORY:
        off = f"{mid.distance:.0f} of {introduced.length} differ, R {mid.radius:.0f}"
    else:
        off = f"{mid.distance:.2f} off, R {mid.radius:.2f}"
    leads = f"it leads to {state.goal}, " if state.goal and state.plan else ""
    return f"{mid.behaviour} because {leads}{rla_title(mid.rla, '', MID)}: {off}"


def format_mid_situation(mid: MidState, introduced: MidIntroduction) -> str:
    """Return the situation of the mid level, symbols newest first, and the condition of the nearest RLA."""
    is_at = "came by" if introduced.kind == HISTORY else "is at"
    here = ", ".join(word for word in mid.here if word) or "nothing yet"
    if mid.nearest is None:
        return f"{is_at} {here}"
    there = ", ".join(word for word in mid.there if word) or "nothing yet"
    return f"{is_at} {here}; {rla_title(mid.nearest, '', MID)} knows {there}"


def format_surprise(surprise: SurpriseState) -> str:
    """Return a line about a surprise: the RLA, its follow-up, and how far it was from its expectation."""
    after, came = (rla_title(each, "", surprise.level) for each in (surprise.rla, surprise.follow_up))
    new = ", which had never followed it" if surprise.new else ""
    return f"surprise: {surprise.times:.1f} times as far off as usual after {after}; {came} took over{new}"


def is_notable(surprise: SurpriseState) -> bool:
    """Return whether to print a surprise: the basic level has many, so only those from LOUD_FROM on."""
    return surprise.level == MID or surprise.times >= LOUD_FROM


def format_state(state: State) -> str:
    """Return the robot's action and its reason, without numbers that change all the time."""
    stands = state.standing
    if stands.reason is not StandReason.DRIVES:
        return standing_headline(stands, GO_IN_TERMINAL) + (f"; {state.trouble}" if state.trouble else "")
    if state.action is not None:
        if state.rla is None:
            return f"{state.action}, by {state.teacher}"
        return f"{state.action} by {rla_title(state.rla, state.behaviour, image=state.image)}"
    return ""


def format_opinion(state: State, appraisals: Sequence[AppraisalName]) -> str:
    """Return the critic's appraisal of a state, and its agreement with the teacher."""
    name = next((each.name for each in appraisals if each.value == state.opinion), None)
    thinks = "does not know this situation" if name is None else f"thinks {name}"
    return f"critic: {thinks} · {format_trust(state)}"


def format_trust(state: State) -> str:
    """Return the agreement of the critic with its teacher, a ratio, and whether it is trusted."""
    if state.agreement is None:
        bad, good = state.signals_missing
        missing = " and ".join(f"{count} {of}" for count, of in ((bad, "bad"), (good, "good")) if count)
        return f"needs {missing or 'a few'} signals from you (not trusted)"
    share = math.floor(state.agreement * 100) / 100  # not rounded up to the bound that it misses
    trusted = "trusted" if state.trusted else "not trusted"
    return f"agrees with you {share:.2f} ({'; '.join(part for part in (trusted, format_role(state)) if part)})"


def format_role(state: State) -> str:
    """Return the activity of the critic in phase 5; empty while it only listens."""
    match state.role:
        case CriticState.LISTENS:
            return ""
        case CriticState.MEASURES:
            return "measures the driving"
        case CriticState.NOT_NEEDED:
            percent = math.floor((state.bad_share or 0.0) * 100)  # not rounded up to what it would be needed for
            return f"not needed: {percent} % of the driving was bad"
        case other:
            return other


def lesson_lines(lesson: LessonLine) -> list[str]:
    """Return a line with a lesson and its id, and one for each of its RLAs that contradicts its neighbours."""
    return [
        f"{lesson.command_id}  {lesson.text}{', undone' if lesson.undone else ''}",
        *(
            f"  {each.command_id}  RLA {each.rla} says {each.action}; {neighbours_text(each.actions, each.nearest)}"
            for each in lesson.against
        ),
    ]


def format_critic_change(lesson: LessonLine | None) -> str:
    """Return a line about the last change of the critic; `lesson` is None if it is not known."""
    if lesson is None:
        return "critic: changed nothing lately"
    return f"critic: changed last: {lesson.text}{', undone' if lesson.undone else ''}"
