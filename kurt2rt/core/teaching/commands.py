"""Commands of teachers, shared by the scripted teacher, the terminal and the network.

Four kinds, as in the paper: motor commands, behaviours, reinforcements, and organising commands. A command with a
`command_id` counts once, in any number of copies; the others are streams in which the newest message counts.
`seen_tick` is the tick of the newest state that the teacher had; None for a teacher in the same program.
"""

from dataclasses import dataclass

from kurt2rt.core.decision.goal import Goal
from kurt2rt.core.outcome import Code, Outcome
from kurt2rt.core.rla.phase import Phase
from kurt2rt.core.rla.rla import BASIC

MOST_SEGMENTS = 12
"""Largest number of segments of a drive by hand that are published; older ones stay untaught."""

# Motor commands and presence: streams.


@dataclass(frozen=True, slots=True)
class Watch:
    """Sign that the teacher is present; a robot that requires a teacher stands without it."""

    teacher: str
    seen_tick: int


@dataclass(frozen=True, slots=True)
class Drive:
    """Speeds of manual drive, which lasts while these messages come (deadman switch)."""

    teacher: str
    seen_tick: int
    press_id: int
    """Press id, larger than that of any press before; a stop ends a press permanently."""
    left_m_s: float
    right_m_s: float


@dataclass(frozen=True, slots=True)
class HoldAction:
    """Action of the repertoire that drives while these messages come (deadman switch), and is taught on the way.

    After the release the robot goes on by its RLAs, unlike after `Drive`.
    """

    teacher: str
    seen_tick: int
    press_id: int
    """Press id, larger than that of any press before; manual drive and holds count in one sequence."""
    action: str
    """Name in the repertoire; it may change within a press."""


Stream = Watch | Drive | HoldAction
"""Message of a stream, in which the newest one counts."""


# Behaviours.


@dataclass(frozen=True, slots=True)
class RunBehaviour:
    """Run one action of the repertoire for `ticks` ticks in place of the RLAs; the robot stands afterwards."""

    command_id: str
    teacher: str
    action: str
    ticks: int
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class Teach:
    """Answer a situation by a new RLA with this action (phase 1)."""

    command_id: str
    teacher: str
    action: str
    """Name in the repertoire; at the mid level a taught behaviour."""
    decision_tick: int | None = None
    """Tick of the situation; None: the present one."""
    level: str = BASIC
    """Level of the situation: BASIC, or MID if the robot has a mid level."""
    alternative: bool = False
    """True at the mid level to add an alternative to the RLAs that know the situation already."""
    seen_tick: int | None = None
    """Newest state that the teacher had; from it the teacher's delay is measured."""


@dataclass(frozen=True, slots=True)
class Correct:
    """Replace the action in a situation (phase 2).

    Close to the nearest RLA's condition its action is replaced. Farther off a new RLA is inserted, because replacing
    would flip one RLA between situations that contradict each other.
    """

    command_id: str
    teacher: str
    action: str
    decision_tick: int | None = None
    """Tick of the wrong decision; None: the present one."""
    level: str = BASIC
    """Level of the wrong decision, as in `Teach`."""
    late: bool = False
    """True for a person's press: it is about the decision before `decision_tick`, or else before `seen_tick`, by the
    teacher's delay."""
    seen_tick: int | None = None
    """Newest state that the teacher had; None: the present tick."""


@dataclass(frozen=True, slots=True)
class TeachShown:
    """Teach what was driven by hand: segments of the newest demonstration, which its teacher has seen."""

    command_id: str
    teacher: str
    press_id: int
    """Press of the demonstration."""
    segments: tuple[int, ...]
    """Indexes of the published segments that are right."""


@dataclass(frozen=True, slots=True)
class ReplaceAction:
    """Give one RLA another action (phase 2)."""

    command_id: str
    teacher: str
    rla_id: int
    action: str


@dataclass(frozen=True, slots=True)
class DeleteRla:
    """Delete one RLA while the robot is running (phase 2)."""

    command_id: str
    teacher: str
    rla_id: int


# Reinforcements.


@dataclass(frozen=True, slots=True)
class Reward:
    """Reward of +1 or -1 for the RLAs that drove up to a tick of the last 1000 (phase 3)."""

    command_id: str
    teacher: str
    value: int
    decision_tick: int | None = None
    """Tick of the decision; None: the present one."""


@dataclass(frozen=True, slots=True)
class Appraise:
    """Teach the critic the value of a situation, independent of the action (phase 4)."""

    command_id: str
    teacher: str
    appraisal: str
    """Name in the critic's repertoire: bad, neutral, good."""
    decision_tick: int | None = None
    """Tick of the situation; None: the present one."""


# Organising commands.


@dataclass(frozen=True, slots=True)
class Undo:
    """Undo a lesson."""

    command_id: str
    teacher: str
    lesson: str | None = None
    """Command id of the lesson; None: the last lesson that stands."""


@dataclass(frozen=True, slots=True)
class Pursue:
    """Make another taught behaviour active: only its RLAs compete, and lessons are about it.

    It overrides a mid level until the next junction has been passed.
    """

    command_id: str
    teacher: str
    behaviour: str
    seen_tick: int | None = None
    """A stop or another `Pursue` after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class NameSituation:
    """Give a situation of the mid level a name, such as "door", so that it can be a goal."""

    command_id: str
    teacher: str
    name: str
    """New or existing name; an existing one moves to this situation."""
    decision_tick: int | None = None
    """Tick of the situation; None: the present one."""


@dataclass(frozen=True, slots=True)
class Seek:
    """Go to a goal on taught ways, and stand there."""

    command_id: str
    teacher: str
    goal: Goal
    seen_tick: int | None = None
    """A stop or another goal after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class StopSeeking:
    """Drop the goal; the mid level commands by its RLAs."""

    command_id: str
    teacher: str
    seen_tick: int | None = None
    """A stop or a goal after this tick refuses the command, because a robot that has arrived may drive on."""


@dataclass(frozen=True, slots=True)
class BeAt:
    """Set the location after the robot was put down at a named place."""

    command_id: str
    teacher: str
    name: str
    seen_tick: int | None = None
    """A junction that was passed after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class SetPhase:
    """Set the training phase."""

    command_id: str
    teacher: str
    phase: Phase
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


@dataclass(frozen=True, slots=True)
class SetLessonSpeed:
    """Set the fraction of their speed at which actions drive while a teacher teaches them (slow lessons)."""

    command_id: str
    teacher: str
    share: float
    """SLOWEST of kurt2rt.core.lesson_speed to 1."""


@dataclass(frozen=True, slots=True)
class BeginSession:
    """Begin a session; its teaching time runs."""

    command_id: str
    teacher: str
    name: str


@dataclass(frozen=True, slots=True)
class EndSession:
    """End the session and its teaching time; the robot stands."""

    command_id: str
    teacher: str


@dataclass(frozen=True, slots=True)
class Take:
    """Take control authority, also from another teacher; refused while that one drives by hand."""

    command_id: str
    teacher: str


@dataclass(frozen=True, slots=True)
class HandOver:
    """Give up control authority."""

    command_id: str
    teacher: str
    to: str | None = None
    """Next teacher; None: the first one that commands."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Stand until `Resume`. Every teacher may send it at any time."""

    command_id: str
    teacher: str
    press_id: int | None = None
    """Press id that ends; a later press goes on. None: stop all motion. After a press of `HoldAction` the robot
    goes on by its RLAs."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Drive again after `Stop`, or after the guard latched an emergency stop."""

    command_id: str
    teacher: str
    seen_tick: int | None = None
    """A stop after this tick refuses the command."""


Command = (
    Watch
    | Drive
    | HoldAction
    | RunBehaviour
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
        """Code of the outcome."""
        return self.outcome.code
