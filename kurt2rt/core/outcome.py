"""Outcome of a teacher's command: a code, and the numbers and names that belong to it.

Programs decide by the code; `kurt2rt.core.outcome_text` puts its text into the words of each surface.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Self

from config.errors import TextCode
from simbridge.contracts.world_refusal import WorldRefusal

Field = str | int | tuple[str, ...] | None


class ResultCode(TextCode):
    """Code of the effect of an accepted command, with its text; its fields are in the `Outcome`."""

    REPEATED = ("repeated", "received before; counted once")
    # Control authority and driving.
    TAKEN = ("taken", "{teacher} teaches")
    HANDED_OVER = ("handed over", "{teacher} teaches now")
    RELEASED = ("released", "the robot has no teacher now")
    STOPPED = ("stopped", "the robot stands {until_go}")
    RELEASE_SUPERSEDED = ("release superseded", "that press is over; a later one drives")
    HOLD_RELEASED = ("hold released", "let go; lessons: {lessons}")
    """The robot goes on by its RLAs; `lesson` names the lessons of the hold, if it gave any."""
    RESUMED = ("resumed", "the robot may drive")
    """Its field `stands`, if any, names what still holds the robot: a StandReason, with `says` as its detail."""
    PHASE_SET = ("phase set", "phase {phase}, {name}")
    LESSON_SPEED_SET = ("lesson speed set", "lessons drive at {percent} % of the full speed")
    SESSION_BEGUN = ("session begun", "session {session!r} begins")
    SESSION_ENDED = ("session ended", "session {session!r} is over; the robot stands")
    ACTION_RUNS = ("action runs", "{action} for {ticks} ticks")
    BEHAVIOUR_WANTED = ("behaviour wanted", "follows {wanted}")
    BEHAVIOUR_WANTED_TO_JUNCTION = (
        "behaviour wanted to junction",
        "follows {wanted} until it has passed the next junction",
    )
    GOAL_SOUGHT = ("goal sought", "{sought}")
    """Its field `status` holds a kurt2rt.core.decision.decision.GoalStatus."""
    GOAL_DROPPED = ("goal dropped", "no goal is sought")
    LOCATED = ("located", "the robot is at {name}")
    # Lessons.
    SITUATION_NAMED = ("situation named", "situation named: {name}")
    RLA_TAUGHT = ("rla taught", "{title} taught: {action}")
    RLA_ADDED = ("rla added", "{title} taught next to RLA {next_to}: {action}")
    RLA_CORRECTED = ("rla corrected", "{title} corrected: {action} instead of {was}")
    RLA_ANSWERED = ("rla answered", "{title} answered again: {action}")
    """Answer to an RLA whose action had been withdrawn."""
    RLA_AGREES = ("rla agrees", "{title} says {action} already")
    RLA_CONFLICTS = ("rla conflicts", "{title} says {action} there already; nothing was changed")
    DEMONSTRATION_TAUGHT = (
        "demonstration taught",
        "what you showed is taught: {situations} situations in {segments} segments",
    )
    """Its situations are taught in the next ticks; `lesson` names their lessons."""
    RLA_DELETED = ("rla deleted", "{title} deleted")
    RLA_REWARDED = ("rla rewarded", "{title} rewarded")
    RLA_PUNISHED = ("rla punished", "{title} punished")
    LESSON_UNDONE = ("lesson undone", "undone: {says}")
    HOLD_UNDONE = ("hold undone", "undone: {lessons} lessons of one press")
    """All lessons of a hold or of a demonstration that stood."""
    CRITIC_AGREED = ("critic agreed", "the critic thought {appraisal}, too")
    CRITIC_AGREES = ("critic agrees", "the critic says {appraisal} already")
    """The critic agrees now, but did not in the appraised tick; nothing was changed."""
    # Files, exams and the simulated world.
    COPIED = ("copied", "{name}, {size} bytes")
    EXAM_BEGUN = ("exam begun", "the exam has begun; the robot goes on meanwhile")
    SPEED_SET = ("speed set", "speed {times}")
    NEXT_RUN = ("next run", "world {world}, task {task}: the robot stands until Go")
    KNOWLEDGE_LOADED = ("knowledge loaded", "{lessons} lessons loaded: the robot stands until Go")
    WALL_MOVED = ("wall moved", "{name} moved")
    ROBOT_PLACED = ("robot placed", "the robot stands elsewhere")


class RefusalCode(TextCode):
    """Code for why a command or file was refused, with the text that tells the teacher what to do."""

    # Control authority.
    ANOTHER_TEACHES = ("another teaches", "{teacher} teaches now; ask to be handed over to, or {take}")
    DRIVES_BY_HAND = ("drives by hand", "{teacher} drives by hand just now; stop the robot first")
    NO_TEACHER = ("no teacher", "the robot has no teacher; {take} first")
    CRITICS_NAME = ("critic's name", "{name} is the name of the robot's own critic; teach under another name")
    TEACHER_ABSENT = ("teacher absent", "a behaviour runs only while its teacher is there and watches")
    # Time of the command.
    RESTARTED = ("restarted", "the robot program was started again; {look}, then repeat the command")
    OLD_PICTURE = ("old picture", "what you saw of the robot was old; {look}, then repeat the command")
    OVERTAKEN = ("overtaken", "a newer message came before this one")
    TOO_OFTEN = ("too often", "asked too often; ten times a second is enough")
    TOO_MANY = ("too many", "too many commands wait; repeat the command")
    STOPPED_SINCE = ("stopped since", "the robot was stopped after this command; {look}, then repeat the command")
    STOPPED_BY = ("stopped by", "{teachers} stopped the robot; {go} first")
    ROBOT_STOPPED = ("robot stopped", "the robot is stopped, so no action can be held; {go} first")
    PRESS_OVER = ("press over", "this press is over; {press}")
    JUNCTION_PASSED = ("junction passed", "a junction was passed after this command; {look}, then repeat the command")
    GOAL_SINCE = ("goal since", "another goal was given after this command; {look}, then repeat the command")
    GOAL_IN_SAME_TICK = ("goal in same tick", "another goal was given in the same tick; repeat the command")
    BEHAVIOUR_SINCE = ("behaviour since", "{wanted} was asked for after this command; {look}, then repeat the command")
    TICK_FORGOTTEN = ("tick forgotten", "the decision of tick {tick} is not remembered any more; {look}")
    NOT_SAVED_YET = ("not saved yet", "not saved yet; it may still count: look at the lessons")
    NOT_SAVED = ("not saved", "{says}")
    # Names in the command.
    RESERVED_ID = (
        "reserved id",
        "the id {command_id!r} has a {sign}, which only the robot's own ids have; leave it out",
    )
    NO_ACTION = ("no action", "there is no action {action!r}; the repertoire has: {known}")
    NO_BEHAVIOUR = ("no behaviour", "there is no taught behaviour {behaviour!r}; this task has: {known}")
    NO_APPRAISAL = ("no appraisal", "there is no appraisal {appraisal!r}; the critic knows: {known}")
    NO_RLA = ("no rla", "there is no RLA {rla}; it may have been deleted")
    NO_LEVEL = ("no level", "there is no level {level!r}; levels are: {known}")
    NO_MID_LEVEL = ("no mid level", "this robot has no mid level")
    NO_CRITIC = ("no critic", "this robot has no critic")
    NO_PLACE = ("no place", "there is no place {name!r}; places are: {known}, or an RLA's own such as RLA 12")
    NO_PLACES = ("no places", "this robot's mid level does not know places")
    NOT_NAMED = ("not named", "nothing has the name {name!r}; names are: {known}")
    BAD_NAME = ("bad name", "{name!r} cannot name a situation; give 1 to {longest} letters on one line")
    NO_FEATURE = ("no feature", "{features} cannot be sought; level {level} knows: {known}")
    SESSION_ON = ("session on", "the session {session!r} is on; end it first")
    NO_SESSION = ("no session", "no session is on")
    # Lessons.
    BLIND = ("blind", "the range sensors are silent, so there is no situation; wait for their readings")
    WAS_BLIND = ("was blind", "the range sensors were silent then, so there is no situation")
    NO_DEMONSTRATION = ("no demonstration", "there is no drive by hand to teach; drive by hand and let go first")
    """It was taught already, another press began, or the robot is still driven."""
    NO_SEGMENT = ("no segment", "the drive by hand has {segments} segments; name some of them")
    PLACE_UNKNOWN = ("place unknown", "the robot does not know where it is; say where it is first")
    NO_OTHER_WAY = ("no other way", "another possibility is taught at the mid level; the basic level does one thing")
    SAYS_SO = ("says so", "{title} says {action} there already; delete RLA {delete} instead")
    NO_RLA_DECIDES = ("no rla decides", "the learner that decides has no RLAs; teach it, or undo a lesson")
    NO_SIGNALS = ("no signals", "the learner that decides does not learn from rewards; answer or correct it")
    NO_RLA_DROVE = ("no rla drove", "no RLA drove the robot then; there is nothing to reward or to punish")
    OUTSIDE_RADIUS = (
        "outside radius",
        "the situation lay outside the radius of {title}, or it stood; no RLA is rewarded",
    )
    DROVE_SLOWLY = ("drove slowly", "the robot drove slowly then; reward and appraise what it does at full speed")
    """The named tick was part of a slow lesson, of which values and critic learn nothing."""
    NO_LESSON_SPEED = ("no lesson speed", "lessons drive at {least} to 100 % of the full speed (got {percent} %)")
    NO_LESSON = ("no lesson", "there is no lesson to undo")
    NO_SUCH_LESSON = ("no such lesson", "there is no lesson {lesson!r}")
    UNDONE_ALREADY = ("undone already", "lesson {lesson!r} was undone already")
    STANDS_ALREADY = ("stands already", "lesson {lesson!r} is not undone; there is nothing to redo")
    TAUGHT_AFTER = ("taught after", "lesson {later!r} came after {lesson!r} ({says}); undo it first")
    TAUGHT_INSTEAD = ("taught instead", "lesson {later!r} replaced {lesson!r} ({says}); undo it first")
    STANDS_ON_UNDONE = ("stands on undone", "{lesson!r} was taught after {earlier!r} ({says}); redo {earlier!r} first")
    ACTION_NOT_IN_TASK = (
        "action not in task",
        "{title} would say {action} again, which this task lacks; undo it with the task that it was taught for",
    )
    DOES_NOT_FIT = ("does not fit", "{says}")
    # Files, exams and the simulated world.
    NOT_SIMULATED = ("not simulated", "this robot is not simulated")
    NO_WALL = ("no wall", WorldRefusal.NO_WALL.text)
    WALL_ON_ROBOT = ("wall on robot", WorldRefusal.WALL_ON_ROBOT.text)
    NO_ROOM = ("no room", WorldRefusal.NO_ROOM.text)
    START_BLOCKED = ("start blocked", WorldRefusal.START_BLOCKED.text)
    EXAM_UNDER_WAY = ("exam under way", "an exam is under way; wait for its end")
    EXAM_FAILED = ("exam failed", "{says}")
    """Its field `cause`, as in `next run failed`, `copy failed` and `file unreadable`, is a KnowledgeCode, or empty."""
    EXAM_CRASHED = ("exam crashed", "the exam failed: {error}")
    """The program failed, not its input; so too `next run crashed` and `copy crashed`."""
    NEXT_RUN_UNDER_WAY = ("next run under way", "the next run is being prepared; wait for it")
    NEXT_RUN_FAILED = ("next run failed", "{says}")
    NEXT_RUN_CRASHED = ("next run crashed", "the next run cannot begin: {error}")
    TAUGHT_BY_SCRIPT = ("taught by script", "the scripted teacher teaches this run; start kurt2rt run without --auto")
    NO_WORLD = ("no world", "world: {world!r} is not known; give one of {known}")
    NO_TASK = ("no task", "task: {task!r} is not known; give one of {known}")
    COPY_FAILED = ("copy failed", "{says}")
    COPY_CRASHED = ("copy crashed", "the copy failed: {error}")
    NO_FILE = ("no file", "{name}: not a copy of this run of the program; save or export again")
    FILE_UNREADABLE = ("file unreadable", "{says}")
    UPLOAD_UNKNOWN = (
        "upload unknown",
        "this upload was not begun here, or another one has taken its place; begin again at 0",
    )
    UPLOAD_GAP = ("upload gap", "a part is missing: got the part at {offset}, the next byte is {size}")
    UPLOAD_TOO_LARGE = (
        "upload too large",
        "the file is too large (at most {most_bytes} bytes); give it to kurt2rt run",
    )
    UPLOAD_DIFFERS = ("upload differs", "the part at {offset} differs from the one before; begin again with another id")
    UPLOAD_INCOMPLETE = ("upload incomplete", "the file did not arrive whole (SHA-256); upload it again")
    # Refusals of the teacher's device.
    MALFORMED = ("malformed", "{says}")
    STOPPED_MEANWHILE = ("stopped meanwhile", "{command} was stopped meanwhile")
    NO_PICTURE = ("no picture", "no word from the robot: nothing is sent to it")
    PICTURE_LOST = ("picture lost", "no word from the robot: the press is over")
    RESTARTED_MEANWHILE = ("restarted meanwhile", "the robot program was started again: the press is over")
    NOT_UNDERSTOOD = ("not understood", "the robot's answer is not understood: {says}")


Code = ResultCode | RefusalCode
_CODES: dict[str, Code] = {each.value: each for each in (*ResultCode, *RefusalCode)}


@dataclass(frozen=True, slots=True)
class Outcome:
    """Outcome of a command as a code and the fields of its text; each surface words it (`text_of`).

    The field `says` holds text of another program, or a file name.
    """

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
