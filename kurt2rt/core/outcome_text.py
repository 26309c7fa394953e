"""Texts of outcomes on each surface."""

from collections.abc import Mapping, Sequence
from enum import StrEnum
from string import Formatter

from hal.world_refusal import WorldRefusal
from kurt2rt.core.decision.goal import goal_text
from kurt2rt.core.decision.standing import Standing, StandReason
from kurt2rt.core.decision.standing_text import hindrance_text
from kurt2rt.core.outcome import Code, Field, Outcome, RefusalCode, ResultCode
from kurt2rt.core.rla.event_error import EventFault, InvalidEventError
from kurt2rt.core.rla.rla import BASIC, rla_title


class Surface(StrEnum):
    """Surface on which a teacher reads the text."""

    PAGE = "page"
    TERMINAL = "terminal"
    LOG = "log"
    """Log, and the sentence in a robot's answer."""


_WORDS: dict[Surface, dict[str, str]] = {
    Surface.PAGE: {
        "go": "touch GO",
        "until_go": "until GO",
        "take": "touch Take the robot",
        "press": "let go and press again",
        "look": "look at the page",
    },
    Surface.TERMINAL: {
        "go": "type go",
        "until_go": "until you type go",
        "take": "type take",
        "press": "let go and press again",
        "look": "look at the robot",
    },
    Surface.LOG: {
        "go": "say resume",
        "until_go": "until a teacher says resume",
        "take": "take the robot",
        "press": "let go and press again",
        "look": "look at the robot",
    },
}
"""Names of the controls of each surface."""

_TEXTS: dict[Code, str] = {
    ResultCode.REPEATED: "received before; counted once",
    ResultCode.TAKEN: "{teacher} teaches",
    ResultCode.HANDED_OVER: "{teacher} teaches now",
    ResultCode.RELEASED: "the robot has no teacher now",
    ResultCode.STOPPED: "the robot stands {until_go}",
    ResultCode.RELEASE_SUPERSEDED: "that press is over; a later one drives",
    ResultCode.HOLD_RELEASED: "let go; lessons: {lessons}",
    ResultCode.RESUMED: "the robot may drive",
    ResultCode.PHASE_SET: "phase {phase}, {name}",
    ResultCode.LESSON_SPEED_SET: "lessons drive at {percent} % of the full speed",
    ResultCode.SESSION_BEGUN: "session {session!r} begins",
    ResultCode.SESSION_ENDED: "session {session!r} is over; the robot stands",
    ResultCode.ACTION_RUNS: "{action} for {ticks} ticks",
    ResultCode.BEHAVIOUR_WANTED: "follows {wanted}",
    ResultCode.BEHAVIOUR_WANTED_TO_JUNCTION: "follows {wanted} until it has passed the next junction",
    ResultCode.GOAL_SOUGHT: "{sought}",
    ResultCode.GOAL_DROPPED: "no goal is sought",
    ResultCode.LOCATED: "the robot is at {name}",
    ResultCode.SITUATION_NAMED: "situation named: {name}",
    ResultCode.RLA_TAUGHT: "{title} taught: {action}",
    ResultCode.RLA_ADDED: "{title} taught next to RLA {next_to}: {action}",
    ResultCode.RLA_CORRECTED: "{title} corrected: {action} instead of {was}",
    ResultCode.RLA_ANSWERED: "{title} answered again: {action}",
    ResultCode.RLA_AGREES: "{title} says {action} already",
    ResultCode.RLA_CONFLICTS: "{title} says {action} there already; nothing was changed",
    ResultCode.DEMONSTRATION_TAUGHT: "what you showed is taught: {situations} situations in {segments} segments",
    ResultCode.RLA_DELETED: "{title} deleted",
    ResultCode.RLA_REWARDED: "{title} rewarded",
    ResultCode.RLA_PUNISHED: "{title} punished",
    ResultCode.LESSON_UNDONE: "undone: {says}",
    ResultCode.HOLD_UNDONE: "undone: {lessons} lessons of one press",
    ResultCode.CRITIC_AGREED: "the critic thought {appraisal}, too",
    ResultCode.CRITIC_AGREES: "the critic says {appraisal} already",
    ResultCode.COPIED: "{name}, {size} bytes",
    ResultCode.EXAM_BEGUN: "the exam has begun; the robot goes on meanwhile",
    ResultCode.SPEED_SET: "speed {times}",
    ResultCode.NEXT_RUN: "world {world}, task {task}: the robot stands until Go",
    ResultCode.KNOWLEDGE_LOADED: "{lessons} lessons loaded: the robot stands until Go",
    ResultCode.WALL_MOVED: "{name} moved",
    ResultCode.ROBOT_PLACED: "the robot stands elsewhere",
    RefusalCode.ANOTHER_TEACHES: "{teacher} teaches now; ask to be handed over to, or {take}",
    RefusalCode.DRIVES_BY_HAND: "{teacher} drives by hand just now; stop the robot first",
    RefusalCode.NO_TEACHER: "the robot has no teacher; {take} first",
    RefusalCode.CRITICS_NAME: "{name} is the name of the robot's own critic; teach under another name",
    RefusalCode.TEACHER_ABSENT: "a behaviour runs only while its teacher is there and watches",
    RefusalCode.RESTARTED: "the robot program was started again; {look}, then repeat the command",
    RefusalCode.OLD_PICTURE: "what you saw of the robot was old; {look}, then repeat the command",
    RefusalCode.OVERTAKEN: "a newer message came before this one",
    RefusalCode.TOO_OFTEN: "asked too often; ten times a second is enough",
    RefusalCode.TOO_MANY: "too many commands wait; repeat the command",
    RefusalCode.STOPPED_SINCE: "the robot was stopped after this command; {look}, then repeat the command",
    RefusalCode.STOPPED_BY: "{teachers} stopped the robot; {go} first",
    RefusalCode.ROBOT_STOPPED: "the robot is stopped, so no action can be held; {go} first",
    RefusalCode.PRESS_OVER: "this press is over; {press}",
    RefusalCode.JUNCTION_PASSED: "a junction was passed after this command; {look}, then repeat the command",
    RefusalCode.GOAL_SINCE: "another goal was given after this command; {look}, then repeat the command",
    RefusalCode.GOAL_IN_SAME_TICK: "another goal was given in the same tick; repeat the command",
    RefusalCode.BEHAVIOUR_SINCE: "{wanted} was asked for after this command; {look}, then repeat the command",
    RefusalCode.TICK_FORGOTTEN: "the decision of tick {tick} is not remembered any more; {look}",
    RefusalCode.NOT_SAVED_YET: "not saved yet; it may still count: look at the lessons",
    RefusalCode.NOT_SAVED: "{says}",
    RefusalCode.RESERVED_ID: "the id {command_id!r} has a {sign}, which only the robot's own ids have; leave it out",
    RefusalCode.NO_ACTION: "there is no action {action!r}; the repertoire has: {known}",
    RefusalCode.NO_BEHAVIOUR: "there is no taught behaviour {behaviour!r}; this task has: {known}",
    RefusalCode.NO_APPRAISAL: "there is no appraisal {appraisal!r}; the critic knows: {known}",
    RefusalCode.NO_RLA: "there is no RLA {rla}; it may have been deleted",
    RefusalCode.NO_LEVEL: "there is no level {level!r}; levels are: {known}",
    RefusalCode.NO_MID_LEVEL: "this robot has no mid level",
    RefusalCode.NO_CRITIC: "this robot has no critic",
    RefusalCode.NO_PLACE: "there is no place {name!r}; places are: {known}, or an RLA's own such as RLA 12",
    RefusalCode.NO_PLACES: "this robot's mid level does not know places",
    RefusalCode.NOT_NAMED: "nothing has the name {name!r}; names are: {known}",
    RefusalCode.BAD_NAME: "{name!r} cannot name a situation; give 1 to {longest} letters on one line",
    RefusalCode.NO_FEATURE: "{features} cannot be sought; level {level} knows: {known}",
    RefusalCode.SESSION_ON: "the session {session!r} is on; end it first",
    RefusalCode.NO_SESSION: "no session is on",
    RefusalCode.BLIND: "the range sensors are silent, so there is no situation; wait for their readings",
    RefusalCode.WAS_BLIND: "the range sensors were silent then, so there is no situation",
    RefusalCode.PLACE_UNKNOWN: "the robot does not know where it is; say where it is first",
    RefusalCode.NO_OTHER_WAY: "another possibility is taught at the mid level; the basic level does one thing",
    RefusalCode.SAYS_SO: "{title} says {action} there already; delete RLA {delete} instead",
    RefusalCode.NO_DEMONSTRATION: "there is no drive by hand to teach; drive by hand and let go first",
    RefusalCode.NO_SEGMENT: "the drive by hand has {segments} segments; name some of them",
    RefusalCode.NO_RLA_DECIDES: "the learner that decides has no RLAs; teach it, or undo a lesson",
    RefusalCode.NO_SIGNALS: "the learner that decides does not learn from rewards; answer or correct it",
    RefusalCode.NO_RLA_DROVE: "no RLA drove the robot then; there is nothing to reward or to punish",
    RefusalCode.OUTSIDE_RADIUS: "the situation lay outside the radius of {title}, or it stood; no RLA is rewarded",
    RefusalCode.DROVE_SLOWLY: "the robot drove slowly then; reward and appraise what it does at full speed",
    RefusalCode.NO_LESSON_SPEED: "lessons drive at {least} to 100 % of the full speed (got {percent} %)",
    RefusalCode.NO_LESSON: "there is no lesson to undo",
    RefusalCode.NO_SUCH_LESSON: "there is no lesson {lesson!r}",
    RefusalCode.UNDONE_ALREADY: "lesson {lesson!r} was undone already",
    RefusalCode.STANDS_ALREADY: "lesson {lesson!r} is not undone; there is nothing to redo",
    RefusalCode.TAUGHT_AFTER: "lesson {later!r} came after {lesson!r} ({says}); undo it first",
    RefusalCode.TAUGHT_INSTEAD: "lesson {later!r} replaced {lesson!r} ({says}); undo it first",
    RefusalCode.STANDS_ON_UNDONE: "{lesson!r} was taught after {earlier!r} ({says}); redo {earlier!r} first",
    RefusalCode.ACTION_NOT_IN_TASK: "{title} would say {action} again, which this task lacks; "
    "undo it with the task that it was taught for",
    RefusalCode.DOES_NOT_FIT: "{says}",
    RefusalCode.NOT_SIMULATED: "this robot is not simulated",
    RefusalCode.NO_WALL: WorldRefusal.NO_WALL.text,
    RefusalCode.WALL_ON_ROBOT: WorldRefusal.WALL_ON_ROBOT.text,
    RefusalCode.NO_ROOM: WorldRefusal.NO_ROOM.text,
    RefusalCode.START_BLOCKED: WorldRefusal.START_BLOCKED.text,
    RefusalCode.EXAM_UNDER_WAY: "an exam is under way; wait for its end",
    RefusalCode.EXAM_FAILED: "{says}",
    RefusalCode.EXAM_CRASHED: "the exam failed: {error}",
    RefusalCode.NEXT_RUN_UNDER_WAY: "the next run is being prepared; wait for it",
    RefusalCode.NEXT_RUN_FAILED: "{says}",
    RefusalCode.NEXT_RUN_CRASHED: "the next run cannot begin: {error}",
    RefusalCode.TAUGHT_BY_SCRIPT: "the scripted teacher teaches this run; start kurt2rt run without --auto",
    RefusalCode.NO_WORLD: "world: {world!r} is not known; give one of {known}, rooms-N, flats-N, streets-N, floors-N",
    RefusalCode.NO_TASK: "task: {task!r} is not known; give one of {known}",
    RefusalCode.COPY_FAILED: "{says}",
    RefusalCode.COPY_CRASHED: "the copy failed: {error}",
    RefusalCode.NO_FILE: "{name}: not a copy of this run of the program; save or export again",
    RefusalCode.FILE_UNREADABLE: "{says}",
    RefusalCode.UPLOAD_UNKNOWN: "this upload was not begun here, or another one has taken its place; begin again at 0",
    RefusalCode.UPLOAD_GAP: "a part is missing: got the part at {offset}, the next byte is {size}",
    RefusalCode.UPLOAD_TOO_LARGE: "the file is too large (at most {most_bytes} bytes); give it to kurt2rt run",
    RefusalCode.UPLOAD_DIFFERS: "the part at {offset} differs from the one before; begin again with another id",
    RefusalCode.UPLOAD_INCOMPLETE: "the file did not arrive whole (SHA-256); upload it again",
    RefusalCode.MALFORMED: "{says}",
    RefusalCode.STOPPED_MEANWHILE: "{command} was stopped meanwhile",
    RefusalCode.NO_PICTURE: "no word from the robot: nothing is sent to it",
    RefusalCode.PICTURE_LOST: "no word from the robot: the press is over",
    RefusalCode.RESTARTED_MEANWHILE: "the robot program was started again: the press is over",
    RefusalCode.NOT_UNDERSTOOD: "the robot's answer is not understood: {says}",
}

_TICKS_PER_S = 100
_EVENT_TEXTS = {
    EventFault.NOT_UNDOABLE: "lesson {lesson!r} cannot be undone",
    EventFault.NOT_REDOABLE: "lesson {lesson!r} cannot be redone",
    EventFault.LESSON_EXISTS: "command {command_id!r} has taught a lesson already",
    EventFault.RLA_EXISTS: "RLA {rla_id} cannot be created: ids up to {last} are taken",
    EventFault.NO_RLA: "RLA {rla_id} does not exist (ids 1 to {last} were used; some are deleted)",
    EventFault.BAD_CONDITION: "RLA {rla_id}: {error}",
    EventFault.NOT_FINITE: "the situation named {name!r} holds a value that is not finite",
    EventFault.BAD_SITUATION: "the situation named {name!r} has {got} values, level {level} matches {expected}",
    EventFault.BAD_ACTION: "the action {action!r} cannot be taught; withdraw the RLA's action instead",
    EventFault.BAD_REWARD: "RLA {rla_id}: wrong reward (got {value}, allowed -1, 1)",
    EventFault.WITHDRAWN_ALREADY: "{title} has no action; withdraw an action once",
    EventFault.NO_LEVEL: "{title} is of the level {level!r}, but the file does not list its features",
}

_ONLY_BEHAVIOUR = "the only behaviour"
_MADE_OF = {"title": ("rla",), "wanted": ("behaviour",), "sought": ("goal", "status")}
"""Name in a text -> fields that it is made of."""


def fields_of(code: Code) -> frozenset[str]:
    """Return the names of the fields in the text of a code."""
    shown = {name for _, name, _, _ in Formatter().parse(_TEXTS[code]) if name}
    named = shown - _WORDS[Surface.LOG].keys()
    return frozenset(each for name in named for each in _MADE_OF.get(name, (name,)))


def text_of(outcome: Outcome, surface: Surface = Surface.LOG) -> str:
    """Return a sentence for the teacher, in the words of a surface. Raises KeyError for a missing field."""
    hindrance = _hindrance_text(outcome)
    if hindrance:
        return hindrance
    text = _TEXTS[outcome.code].format(**{**_shown(outcome.fields), **_WORDS[surface]})
    return text + _no_lesson_text(outcome) + _late_press_text(outcome.fields) + _contradiction_text(outcome.fields)


def neighbours_text(actions: Sequence[str], nearest: int) -> str:
    """Return what the neighbours of a contradicting RLA say: their actions, and the id of the nearest of them."""
    return f"all near it say {', '.join(actions)} (RLA {nearest} first)"


def event_error_text(error: InvalidEventError) -> str:
    """Return a sentence for an event that does not fit: the refusal's text if there is a refusal."""
    return _EVENT_TEXTS[error.fault].format(**error.fields) if error.refusal is None else text_of(error.refusal)


def _hindrance_text(outcome: Outcome) -> str:
    """Return the sentence of a resume after which the robot still stands; empty for other outcomes."""
    stands, says = outcome.fields.get("stands"), str(outcome.fields.get("says", ""))
    if outcome.code is not ResultCode.RESUMED or not isinstance(stands, str):
        return ""
    return f"the robot still stands: {hindrance_text(Standing(StandReason(stands), says=says))}"


def _no_lesson_text(outcome: Outcome) -> str:
    """Return why a hold taught nothing, as the end of its sentence; empty for other outcomes."""
    if outcome.code is not ResultCode.HOLD_RELEASED or outcome.fields.get("lessons") != 0:
        return ""
    return "; the robot does this here already, or was answered here, which a short press corrects"


def _late_press_text(fields: Mapping[str, Field]) -> str:
    """Return the end of the sentence of a late press: the decision that it was given to; empty for other outcomes."""
    back, rla = fields.get("put_back_ticks"), fields.get("decided_by")
    if not isinstance(back, int) or back == 0:
        return ""
    by = f" of RLA {rla}" if isinstance(rla, int) else ""
    answers = fields.get("delay_answers")
    why = f", by {answers} of your answers" if answers else ", the usual delay"
    return f"; given to the decision{by} {back / _TICKS_PER_S:.1f} s before the press{why}"


def _contradiction_text(fields: Mapping[str, Field]) -> str:
    """Return the end of the sentence of a lesson that contradicts its neighbours; empty for other outcomes."""
    actions, nearest = fields.get("against"), fields.get("nearest")
    if not isinstance(actions, tuple) or not isinstance(nearest, int):
        return ""
    return f"; {neighbours_text(actions, nearest)}: undo it if your finger slipped"


def _shown(fields: Mapping[str, Field]) -> dict[str, str | int]:
    shown = {key: _plain(key, each) for key, each in fields.items()}
    shown["wanted"] = shown.get("behaviour") or _ONLY_BEHAVIOUR
    if "goal" in fields:
        shown["sought"] = goal_text(str(fields.get("status")), str(fields["goal"]))
    rla = fields.get("rla")
    if isinstance(rla, int):
        shown["title"] = rla_title(rla, str(fields.get("behaviour", "")), str(fields.get("level", BASIC)))
    return shown


def _plain(key: str, value: Field) -> str | int:
    if isinstance(value, tuple):
        return (" and " if key == "teachers" else ", ").join(
            each or "a single one without a name" for each in value
        ) or "nothing"
    return "" if value is None else value
