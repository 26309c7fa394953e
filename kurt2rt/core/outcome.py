"""Outcome of a teacher's command: a code, and the numbers and names that belong to it.

Programs decide by the code; `kurt2rt.core.outcome_text` puts it into words for each surface.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Self

Field = str | int | tuple[str, ...] | None


class ResultCode(StrEnum):
    """Code of an accepted command: the effect."""

    REPEATED = "repeated"
    """A command of this id was applied before; it counts once."""
    # Control authority and driving.
    TAKEN = "taken"
    HANDED_OVER = "handed over"
    RELEASED = "released"
    """The robot has no teacher now."""
    STOPPED = "stopped"
    RELEASE_SUPERSEDED = "release superseded"
    """A later press than the released one drives."""
    HOLD_RELEASED = "hold released"
    """The robot goes on by its RLAs; `lesson` names the lessons of the hold, if it gave any."""
    RESUMED = "resumed"
    """Its field `stands`, if any, names what still holds the robot: a StandReason, with `says` as its detail."""
    PHASE_SET = "phase set"
    LESSON_SPEED_SET = "lesson speed set"
    SESSION_BEGUN = "session begun"
    SESSION_ENDED = "session ended"
    ACTION_RUNS = "action runs"
    BEHAVIOUR_WANTED = "behaviour wanted"
    BEHAVIOUR_WANTED_TO_JUNCTION = "behaviour wanted to junction"
    GOAL_SOUGHT = "goal sought"
    """Its field `status` holds a kurt2rt.core.decision.decision.GoalStatus."""
    GOAL_DROPPED = "goal dropped"
    LOCATED = "located"
    # Lessons.
    SITUATION_NAMED = "situation named"
    RLA_TAUGHT = "rla taught"
    RLA_ADDED = "rla added"
    """Competitor on the condition of other RLAs."""
    RLA_CORRECTED = "rla corrected"
    RLA_ANSWERED = "rla answered"
    """Answer to an RLA whose action had been withdrawn."""
    RLA_AGREES = "rla agrees"
    """The RLA has this action already; nothing was changed."""
    RLA_CONFLICTS = "rla conflicts"
    """Another RLA on its condition has this action already; nothing was changed."""
    DEMONSTRATION_TAUGHT = "demonstration taught"
    """Its situations are taught in the next ticks; `lesson` names their lessons."""
    RLA_DELETED = "rla deleted"
    RLA_REWARDED = "rla rewarded"
    RLA_PUNISHED = "rla punished"
    LESSON_UNDONE = "lesson undone"
    HOLD_UNDONE = "hold undone"
    """All lessons of a hold or of a demonstration that stood."""
    CRITIC_AGREED = "critic agreed"
    CRITIC_AGREES = "critic agrees"
    """The critic agrees now, but did not in the appraised tick; nothing was changed."""
    # Files, exams and the simulated world.
    COPIED = "copied"
    EXAM_BEGUN = "exam begun"
    SPEED_SET = "speed set"
    NEXT_RUN = "next run"
    KNOWLEDGE_LOADED = "knowledge loaded"
    WALL_MOVED = "wall moved"
    ROBOT_PLACED = "robot placed"


class RefusalCode(StrEnum):
    """Code of a refused command or file: the reason."""

    # Control authority.
    ANOTHER_TEACHES = "another teaches"
    DRIVES_BY_HAND = "drives by hand"
    """The teacher drives manually, so no other teacher can take the robot."""
    NO_TEACHER = "no teacher"
    CRITICS_NAME = "critic's name"
    TEACHER_ABSENT = "teacher absent"
    # Time of the command.
    RESTARTED = "restarted"
    OLD_PICTURE = "old picture"
    OVERTAKEN = "overtaken"
    TOO_OFTEN = "too often"
    TOO_MANY = "too many"
    STOPPED_SINCE = "stopped since"
    STOPPED_BY = "stopped by"
    ROBOT_STOPPED = "robot stopped"
    """A stop lasts until a resume, so that no action is held."""
    PRESS_OVER = "press over"
    JUNCTION_PASSED = "junction passed"
    GOAL_SINCE = "goal since"
    GOAL_IN_SAME_TICK = "goal in same tick"
    BEHAVIOUR_SINCE = "behaviour since"
    TICK_FORGOTTEN = "tick forgotten"
    NOT_SAVED_YET = "not saved yet"
    NOT_SAVED = "not saved"
    # Names in the command.
    RESERVED_ID = "reserved id"
    NO_ACTION = "no action"
    NO_BEHAVIOUR = "no behaviour"
    NO_APPRAISAL = "no appraisal"
    NO_RLA = "no rla"
    NO_LEVEL = "no level"
    NO_MID_LEVEL = "no mid level"
    NO_CRITIC = "no critic"
    NO_PLACE = "no place"
    NO_PLACES = "no places"
    """The mid level knows no places."""
    NOT_NAMED = "not named"
    BAD_NAME = "bad name"
    NO_FEATURE = "no feature"
    SESSION_ON = "session on"
    NO_SESSION = "no session"
    # Lessons.
    BLIND = "blind"
    """The infra-red sensors are silent."""
    WAS_BLIND = "was blind"
    """The infra-red sensors were silent in the named tick."""
    NO_DEMONSTRATION = "no demonstration"
    """It was taught already, another press began, or the robot is still driven."""
    NO_SEGMENT = "no segment"
    PLACE_UNKNOWN = "place unknown"
    NO_OTHER_WAY = "no other way"
    """The basic level has one action per situation."""
    SAYS_SO = "says so"
    """Another RLA on its condition has this action already."""
    NO_RLA_DECIDES = "no rla decides"
    """A learner that is no RLA system decides, and has no RLAs to change."""
    NO_SIGNALS = "no signals"
    """A learner that is no RLA system decides, and does not learn from rewards."""
    NO_RLA_DROVE = "no rla drove"
    OUTSIDE_RADIUS = "outside radius"
    DROVE_SLOWLY = "drove slowly"
    """The named tick was part of a slow lesson, of which values and critic learn nothing."""
    NO_LESSON_SPEED = "no lesson speed"
    """The lesson speed is out of its range."""
    NO_LESSON = "no lesson"
    NO_SUCH_LESSON = "no such lesson"
    UNDONE_ALREADY = "undone already"
    STANDS_ALREADY = "stands already"
    TAUGHT_AFTER = "taught after"
    """A later lesson is above this one in its stack."""
    TAUGHT_INSTEAD = "taught instead"
    """Another lesson took its place in the stack."""
    STANDS_ON_UNDONE = "stands on undone"
    ACTION_NOT_IN_TASK = "action not in task"
    DOES_NOT_FIT = "does not fit"
    # Files, exams and the simulated world.
    NOT_SIMULATED = "not simulated"
    NO_WALL = "no wall"
    WALL_ON_ROBOT = "wall on robot"
    NO_ROOM = "no room"
    START_BLOCKED = "start blocked"
    EXAM_UNDER_WAY = "exam under way"
    EXAM_FAILED = "exam failed"
    """Its field `cause`, as in `next run failed`, `copy failed` and `file unreadable`, is a KnowledgeCode, or empty."""
    EXAM_CRASHED = "exam crashed"
    """The program failed, not its input; so too `next run crashed` and `copy crashed`."""
    NEXT_RUN_UNDER_WAY = "next run under way"
    NEXT_RUN_FAILED = "next run failed"
    NEXT_RUN_CRASHED = "next run crashed"
    TAUGHT_BY_SCRIPT = "taught by script"
    NO_WORLD = "no world"
    NO_TASK = "no task"
    COPY_FAILED = "copy failed"
    COPY_CRASHED = "copy crashed"
    NO_FILE = "no file"
    FILE_UNREADABLE = "file unreadable"
    UPLOAD_UNKNOWN = "upload unknown"
    UPLOAD_GAP = "upload gap"
    UPLOAD_TOO_LARGE = "upload too large"
    UPLOAD_DIFFERS = "upload differs"
    UPLOAD_INCOMPLETE = "upload incomplete"
    # Refusals of the teacher's device.
    MALFORMED = "malformed"
    STOPPED_MEANWHILE = "stopped meanwhile"
    NO_PICTURE = "no picture"
    """No press begins, because no recent state of the robot arrived."""
    PICTURE_LOST = "picture lost"
    """A press ended, because no states of the robot arrive."""
    RESTARTED_MEANWHILE = "restarted meanwhile"
    NOT_UNDERSTOOD = "not understood"


Code = ResultCode | RefusalCode
_CODES: dict[str, Code] = {each.value: each for each in (*ResultCode, *RefusalCode)}


@dataclass(frozen=True, slots=True)
class Outcome:
    """Code with its fields; the field `says` holds text of another program, or a file name."""

    code: Code
    fields: Mapping[str, Field] = field(default_factory=dict)

    @classmethod
    def of(cls, code: Code, **fields: Field) -> Self:
        """Return the outcome of a code with these fields."""
        return cls(code, fields)

    @property
    def accepted(self) -> bool:
        """Return whether the code says that the command was applied."""
        return isinstance(self.code, ResultCode)


def outcome_in(code: object, fields: object) -> Outcome | None:
    """Return the outcome of a code and fields from the wire.

    Returns None for an unknown code, or for fields that are no mapping of texts, whole numbers, lists and None.
    """
    if not isinstance(code, str) or not isinstance(fields, Mapping) or code not in _CODES:
        return None
    if not all(each is None or isinstance(each, str | int | list) for each in fields.values()):
        return None
    return Outcome(
        _CODES[code],
        {str(key): tuple(map(str, each)) if isinstance(each, list) else each for key, each in fields.items()},
    )


class CommandRefusedError(ValueError):
    """Refusal of a command; `outcome` holds the code and its fields."""

    def __init__(self, code: RefusalCode, **fields: Field) -> None:
        super().__init__(code, fields)
        self.outcome = Outcome(code, fields)


def refuse(outcome: Outcome | None) -> None:
    """Raise CommandRefusedError with `outcome`; do nothing if it is None."""
    if outcome is not None:
        assert isinstance(outcome.code, RefusalCode)
        raise CommandRefusedError(outcome.code, **outcome.fields)
