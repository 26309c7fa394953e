"""Commands of teachers, shared by the scripted teacher, the terminal and the network.

Four kinds, as in the paper: motor commands, behaviours, reinforcements, and organising commands. A command with a
`command_id` counts once, in any number of copies; the others are streams in which the newest message counts.
`seen_tick` is the tick of the newest state that the teacher had; None for a teacher in the same program.
"""

from dataclasses import dataclass
from typing import Annotated, ClassVar

from kurt2rt.core.decision.goal import Goal
from kurt2rt.core.message_fields import Int, Name, Number, OneOf, Truth, UpTo
from kurt2rt.core.outcome import Code, Outcome
from kurt2rt.core.rla.rla import BASIC
from kurt2rt.core.teaching.message_fields import (
    LONGEST_BEHAVIOUR_TICKS,
    MOST_SEGMENTS,
    SLOWEST_PERCENT,
    GoalField,
    Level,
    PhaseNumber,
    Speed,
)


@dataclass(frozen=True, slots=True)
class StreamCommand:
    """Base of the streams. The fields with a check are the body of the message at `path`, in order."""

    path: ClassVar[str]
    teacher: str
    seen_tick: Number
    """Tick of the newest state or answer that the device had."""


@dataclass(frozen=True, slots=True)
class SingleCommand:
    """Base of the commands that count once. The fields with a check are the body of the message at `path`, in order."""

    path: ClassVar[str]
    moves: ClassVar[bool] = False
    """True if a standing robot may drive after it: the state that the teacher saw must not be older than 1 s."""
    typed: ClassVar[tuple[str, str] | None] = None
    """Form and meaning of its line in a terminal, for the help; None if the terminal tells it itself."""
    command_id: str
    teacher: str


# Motor commands and presence: streams.


@dataclass(frozen=True, slots=True)
class Watch(StreamCommand):
    """Sign that the teacher is present; a robot that requires a teacher stands without it."""

    path: ClassVar[str] = "/watch"


@dataclass(frozen=True, slots=True)
class Drive(StreamCommand):
    """Speeds of manual drive, which lasts while these messages come (deadman switch)."""

    path: ClassVar[str] = "/drive"
    press_id: Number
    """Press id, larger than that of any press before; a stop ends a press permanently."""
    left_m_s: Speed
    right_m_s: Speed


@dataclass(frozen=True, slots=True)
class HoldAction(StreamCommand):
    """Action of the repertoire that drives while these messages come (deadman switch), and is taught on the way.

    After the release the robot goes on by its RLAs, unlike after `Drive`.
    """

    path: ClassVar[str] = "/hold"
    press_id: Number
    """Press id, larger than that of any press before; manual drive and holds count in one sequence."""
    action: Name
    """Name in the repertoire; it may change within a press."""


Stream = Watch | Drive | HoldAction
"""Message of a stream, in which the newest one counts."""


# Behaviours.


@dataclass(frozen=True, slots=True)
class RunBehaviour(SingleCommand):
    """Command that runs one action of the repertoire for `ticks` ticks instead of the RLAs, then stands."""

    path: ClassVar[str] = "/behaviour"
    moves: ClassVar[bool] = True
    action: Name
    ticks: Annotated[int, Int(1, LONGEST_BEHAVIOUR_TICKS)]
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class Teach(SingleCommand):
    """Command that answers a situation in which the robot asks: a new RLA with this action (phase 1)."""

    path: ClassVar[str] = "/answer"
    action: Name
    """Name in the repertoire; at the mid level a taught behaviour."""
    decision_tick: Number | None = None
    """Tick of the situation; None: the present one."""
    level: Level = BASIC
    """Level of the situation: BASIC, or MID if the robot has a mid level."""
    alternative: Truth = False
    """True at the mid level to add an alternative to the RLAs that know the situation already."""
    seen_tick: int | None = None
    """Newest state that the teacher had; from it the teacher's delay is measured."""


@dataclass(frozen=True, slots=True)
class Correct(SingleCommand):
    """Replace the action in a situation, because the robot does the wrong thing there (phase 2; paper, section IV.B).

    Close to the nearest condition, within a share of R that the task sets, its action is replaced. Farther off a new
    RLA is inserted, because replacing would flip one RLA between situations that contradict each other.
    `LessonBuilder` makes the event; the new action drives in the next tick.
    """

    path: ClassVar[str] = "/correct"
    action: Name
    decision_tick: Number | None = None
    """Tick of the wrong decision; None: the present one."""
    level: Level = BASIC
    """Level of the wrong decision, as in `Teach`."""
    late: Truth = False
    """True for a person's press: it is about the decision before `decision_tick`, or else before `seen_tick`, by the
    teacher's delay."""
    seen_tick: int | None = None
    """Newest state that the teacher had; None: the present tick."""


@dataclass(frozen=True, slots=True)
class TeachShown(SingleCommand):
    """Command that teaches segments of the newest drive by hand, which its teacher has seen."""

    path: ClassVar[str] = "/shown"
    press_id: Number
    """Press of the demonstration."""
    segments: Annotated[tuple[Number, ...], UpTo(MOST_SEGMENTS)]
    """Indexes of the published segments that are right."""


@dataclass(frozen=True, slots=True)
class ReplaceAction(SingleCommand):
    """Command that gives the RLA of an id another action (phase 2)."""

    path: ClassVar[str] = "/replace"
    typed = ("replace N ACTION", "change the action of RLA N")
    rla_id: Number
    action: Name


@dataclass(frozen=True, slots=True)
class DeleteRla(SingleCommand):
    """Command that deletes the RLA of an id while the robot is running (phase 2)."""

    path: ClassVar[str] = "/delete"
    typed = ("delete N", "end RLA N")
    rla_id: Number


# Reinforcements.


@dataclass(frozen=True, slots=True)
class Reward(SingleCommand):
    """Reward of +1 or -1 for the RLAs that drove up to a tick of the last 1000 (phase 3; paper, section IV.C).

    Each RLA gets its share of the eligibility trace; `TdLambda` adds it to the values. An RLA whose value falls
    below the threshold loses its action, and the robot asks there. The page's buttons are called right and wrong.
    """

    path: ClassVar[str] = "/reward"
    value: Annotated[int, OneOf((1, -1))]
    decision_tick: Number | None = None
    """Tick of the decision; None: the present one."""


@dataclass(frozen=True, slots=True)
class Appraise(SingleCommand):
    """Command that teaches the critic the value of a situation, independent of the action (phase 4)."""

    path: ClassVar[str] = "/appraise"
    appraisal: Name
    """Name in the critic's repertoire: bad, neutral, good."""
    decision_tick: Number | None = None
    """Tick of the situation; None: the present one."""


# Organising commands.


@dataclass(frozen=True, slots=True)
class Undo(SingleCommand):
    """Command that undoes a lesson, or all of a hold: its RLA, name or reward is as before."""

    path: ClassVar[str] = "/undo"
    typed = ("undo [LESSON]", "take the last lesson back, or the one of that id")
    lesson: Name | None = None
    """Command id of the lesson; None: the last lesson that stands."""


@dataclass(frozen=True, slots=True)
class Pursue(SingleCommand):
    """Command that makes another taught behaviour active: only its RLAs compete, and lessons are about it.

    It overrides a mid level until the next junction has been passed.
    """

    path: ClassVar[str] = "/pursue"
    moves: ClassVar[bool] = True
    behaviour: Name
    seen_tick: int | None = None
    """A stop or another `Pursue` after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class NameSituation(SingleCommand):
    """Command that gives a situation of the mid level a name, such as "door", so that it can be a goal."""

    path: ClassVar[str] = "/name"
    name: Name
    """New or existing name; an existing one moves to this situation."""
    decision_tick: Number | None = None
    """Tick of the situation; None: the present one."""


@dataclass(frozen=True, slots=True)
class Seek(SingleCommand):
    """Command to drive to a goal on taught ways, and stand there."""

    path: ClassVar[str] = "/seek"
    moves: ClassVar[bool] = True
    goal: Annotated[Goal, GoalField()]
    seen_tick: int | None = None
    """A stop or another goal after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class StopSeeking(SingleCommand):
    """Command that drops the goal; the mid level commands by its RLAs again."""

    path: ClassVar[str] = "/seek/stop"
    moves: ClassVar[bool] = True
    seen_tick: int | None = None
    """A stop or a goal after this tick refuses the command, because a robot that has arrived may drive on."""


@dataclass(frozen=True, slots=True)
class BeAt(SingleCommand):
    """Command that tells a robot that was put down at a named place where it is."""

    path: ClassVar[str] = "/here"
    name: Name
    seen_tick: int | None = None
    """A junction that was passed after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class SetPhase(SingleCommand):
    """Command that sets the training phase, 1 to 5; a stop after `seen_tick` refuses phase 5."""

    path: ClassVar[str] = "/phase"
    typed = ("phase 1 to 5", "supervised, corrections, reinforcement, critic, autonomous")
    moves: ClassVar[bool] = True
    phase: PhaseNumber
    """Phase 5 drives without a teacher."""
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class SetLessonSpeed(SingleCommand):
    """Command that sets the speed at which actions drive while a teacher teaches them (slow lessons)."""

    path: ClassVar[str] = "/lesson/speed"
    typed = ("speed PERCENT", "slow lessons: in phases 1 and 2 it drives at 20 to 100 % of its speed")
    percent: Annotated[int, Int(SLOWEST_PERCENT, 100)]
    """Speed in per cent of their own."""


@dataclass(frozen=True, slots=True)
class BeginSession(SingleCommand):
    """Command that begins a named session; the clock of its teaching time starts."""

    path: ClassVar[str] = "/session/begin"
    typed = ("begin [NAME]", "begin a session of teaching, with its clock")
    name: Name


@dataclass(frozen=True, slots=True)
class EndSession(SingleCommand):
    """Command that ends the session and its teaching time; the robot stands."""

    path: ClassVar[str] = "/session/end"
    typed = ("end", "end the session; the robot stands")


@dataclass(frozen=True, slots=True)
class Take(SingleCommand):
    """Command that gives its teacher control authority, also from another teacher.

    It is refused while that one drives by hand.
    """

    path: ClassVar[str] = "/take"
    typed = ("take", "become the teacher")
    moves: ClassVar[bool] = True


@dataclass(frozen=True, slots=True)
class HandOver(SingleCommand):
    """Command that gives control authority up, to another teacher or to anyone."""

    path: ClassVar[str] = "/release"
    typed = ("release [NAME]", "hand over to another one")
    to: Name | None = None
    """Next teacher; None: the first one that commands."""


@dataclass(frozen=True, slots=True)
class Stop(SingleCommand):
    """Command to stand until `Resume`; every paired device may send it, also one that does not teach.

    The tick after its arrival brakes. Commands that were given on a state before it are refused.
    """

    path: ClassVar[str] = "/stop"
    press_id: Number | None = None
    """Press id that ends; a later press goes on. None: stop all motion. After a press of `HoldAction` the robot
    goes on by its RLAs."""


@dataclass(frozen=True, slots=True)
class Resume(SingleCommand):
    """Command to drive again after `Stop`, or after the guard latched: GO on the page, `go` in a terminal.

    It is refused if the robot was stopped after the state that its teacher saw (`seen_tick`). The robot still stands
    if it has another reason, such as silent sensors; the answer then names it.
    """

    path: ClassVar[str] = "/resume"
    typed = ("go", "the robot drives where it knows the way")
    moves: ClassVar[bool] = True
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


Single = (
    RunBehaviour
    | Teach
    | Correct
    | TeachShown
    | ReplaceAction
    | DeleteRla
    | Reward
    | Appraise
    | Undo
    | Pursue
    | NameSituation
    | Seek
    | StopSeeking
    | BeAt
    | SetPhase
    | SetLessonSpeed
    | BeginSession
    | EndSession
    | Take
    | HandOver
    | Stop
    | Resume
)
"""Command that counts once."""

Command = Stream | Single
"""Request of a teacher's device; a single one is acknowledged once its lesson is on disk.

Scripted teachers, page and terminal give the same ones. `CommandHandler` carries them out at the start of a tick.
"""


@dataclass(frozen=True, slots=True)
class CommandResult:
    """Outcome of a command in the tick that took it. A lesson is safe only after the journal acknowledged it."""

    command_id: str
    outcome: Outcome
    lesson: bool = False
    """True if it became an event for the journal."""

    @property
    def accepted(self) -> bool:
        """Return whether the command was carried out."""
        return self.outcome.accepted

    @property
    def code(self) -> Code:
        """Code of the outcome, a word of the wire contract."""
        return self.outcome.code
