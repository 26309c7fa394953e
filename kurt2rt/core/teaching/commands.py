"""What a teacher can tell the robot: one typed interface for the scripted teacher, the terminal and the network.

Four kinds, as in the paper: motor commands, behaviours, reinforcements, and organising commands. Those with a
`command_id` count once however often they come; the others are a stream of which the newest counts.
"""

from dataclasses import dataclass

from kurt2rt.core.decision.goal import Goal
from kurt2rt.core.outcome import Code, Outcome
from kurt2rt.core.rla.rla import BASIC, Phase

# Motor commands and presence: streams.


@dataclass(frozen=True, slots=True)
class Watch:
    """The teacher is there and sees the robot; while nobody is, a robot that needs a teacher stands."""

    teacher: str
    seen_tick: int
    """Tick of the newest sign of the robot that he had."""


@dataclass(frozen=True, slots=True)
class Drive:
    """The teacher drives by hand for as long as these come (a dead man's handle)."""

    teacher: str
    seen_tick: int
    """Tick of the newest sign of the robot that he had."""
    hold: int
    """Number of this press of the button, larger than that of any press before; a stop ends a press for good."""
    left_m_s: float
    right_m_s: float


# Behaviours.


@dataclass(frozen=True, slots=True)
class RunBehaviour:
    """Run one action of the repertoire for a time, whatever the RLAs say; the robot stands afterwards."""

    command_id: str
    teacher: str
    action: str
    ticks: int
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a stop after it is not lifted. None: he stands by."""


@dataclass(frozen=True, slots=True)
class Teach:
    """Answer a situation: a new RLA with this action stands there (phase 1)."""

    command_id: str
    teacher: str
    action: str
    """A name in the repertoire; at the mid level a taught behaviour."""
    decision_tick: int | None = None
    """The situation of which tick; None: the present one."""
    level: str = BASIC
    """Whose situation it is: BASIC, or MID where the robot has a mid level."""
    beside: bool = False
    """At the mid level: this is possible there, too, beside what the RLAs say that know the situation already."""


@dataclass(frozen=True, slots=True)
class Correct:
    """Another action is right in a situation (phase 2).

    Close to the nearest RLA's condition its action is replaced; farther off a new RLA is inserted, because replacing
    would flip one RLA to and fro between situations that contradict each other.
    """

    command_id: str
    teacher: str
    action: str
    decision_tick: int | None = None
    """The decision of which tick was wrong; None: the present one."""
    level: str = BASIC
    """Whose decision it was, as in `Teach`."""


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
    """Praise (+1) or blame (-1) for the RLA that decided in a tick, however long ago it was."""

    command_id: str
    teacher: str
    value: int
    decision_tick: int | None = None
    """The decision of which tick; None: the present one."""


@dataclass(frozen=True, slots=True)
class Appraise:
    """Teach the critic what a situation is worth, whoever drove in it and whatever was done (phase 4)."""

    command_id: str
    teacher: str
    appraisal: str
    """A name in the critic's repertoire: bad, neutral, good."""
    decision_tick: int | None = None
    """The situation of which tick; None: the present one."""


# Organising commands.


@dataclass(frozen=True, slots=True)
class Undo:
    """Take a lesson back."""

    command_id: str
    teacher: str
    lesson: str | None = None
    """Command id of the lesson; None: the last one that still stands."""


@dataclass(frozen=True, slots=True)
class Pursue:
    """Follow another taught behaviour from now on: only its RLAs answer, and lessons are about it.

    Where a mid level commands, this goes before it until the next junction has been passed.
    """

    command_id: str
    teacher: str
    behaviour: str
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a stop or another `Pursue` after it goes before.
    None: he stands by.
    """


@dataclass(frozen=True, slots=True)
class NameSituation:
    """Give a situation of the mid level a name, so that the robot can be sent there: door, this junction."""

    command_id: str
    teacher: str
    name: str
    """One that was given already means this situation from now on."""
    decision_tick: int | None = None
    """The situation of which tick; None: the present one."""


@dataclass(frozen=True, slots=True)
class Seek:
    """Go to a goal, by whatever ways were taught; stand there."""

    command_id: str
    teacher: str
    goal: Goal
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a stop, or another goal, after it goes before.
    None: he stands by.
    """


@dataclass(frozen=True, slots=True)
class StopSeeking:
    """Seek no goal any more: the mid level commands as ever."""

    command_id: str
    teacher: str
    seen_tick: int | None = None
    """As in `Seek`: a robot that has arrived may drive on."""


@dataclass(frozen=True, slots=True)
class BeAt:
    """The robot was set down at a place that has a name: its reckoning goes on from there."""

    command_id: str
    teacher: str
    name: str
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a junction passed after it goes before.
    None: he stands by.
    """


@dataclass(frozen=True, slots=True)
class SetPhase:
    """The training phase from now on."""

    command_id: str
    teacher: str
    phase: Phase
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a stop after it is not lifted. None: he stands by."""


@dataclass(frozen=True, slots=True)
class BeginSession:
    """Teaching begins: the teaching clock runs."""

    command_id: str
    teacher: str
    name: str


@dataclass(frozen=True, slots=True)
class EndSession:
    """Teaching ends: the teaching clock stops and the robot stands."""

    command_id: str
    teacher: str


@dataclass(frozen=True, slots=True)
class Take:
    """Be the teacher from now on, also where another one is; not while that one drives by hand."""

    command_id: str
    teacher: str


@dataclass(frozen=True, slots=True)
class HandOver:
    """Be the teacher no longer."""

    command_id: str
    teacher: str
    to: str | None = None
    """Who is the teacher next; None: whoever takes it."""


@dataclass(frozen=True, slots=True)
class Stop:
    """Stand until `Resume`. Every teacher may say it, at any time."""

    command_id: str
    teacher: str
    hold: int | None = None
    """The press that he lets go, which is no reason to end a later one; None: whatever moves the robot."""


@dataclass(frozen=True, slots=True)
class Resume:
    """Drive again after `Stop`, or after the guard latched an emergency stop."""

    command_id: str
    teacher: str
    seen_tick: int | None = None
    """Tick of the newest sign of the robot that the teacher had; a stop after it is not lifted. None: he stands by."""


Command = (
    Watch
    | Drive
    | RunBehaviour
    | Teach
    | Correct
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
    | BeginSession
    | EndSession
    | Take
    | HandOver
    | Stop
    | Resume
)


@dataclass(frozen=True, slots=True)
class CommandResult:
    """What became of a command in the tick that took it. A lesson is safe only once the journal says so as well."""

    command_id: str
    outcome: Outcome
    lesson: bool = False
    """Whether it became an event that has to reach the journal."""

    @property
    def accepted(self) -> bool:
        """Whether the command was carried out."""
        return self.outcome.accepted

    @property
    def code(self) -> Code:
        """Code of the outcome."""
        return self.outcome.code
