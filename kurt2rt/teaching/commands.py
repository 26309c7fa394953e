"""What a teacher can tell the robot: one typed interface for the scripted teacher, the terminal and the network."""

from dataclasses import dataclass

from kurt2rt.rla.rla import Phase


@dataclass(frozen=True, slots=True)
class Teach:
    """Answer for the present situation: a new RLA with this action stands there (phase 1)."""

    command_id: str
    teacher: str
    action: str


@dataclass(frozen=True, slots=True)
class Correct:
    """Another action is right in the present situation (phase 2).

    Close to the nearest RLA's condition its action is replaced; farther off a new RLA is inserted, because replacing
    would flip one RLA to and fro between situations that contradict each other.
    """

    command_id: str
    teacher: str
    action: str


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


@dataclass(frozen=True, slots=True)
class SetPhase:
    """Organising: the training phase from now on."""

    command_id: str
    teacher: str
    phase: Phase


@dataclass(frozen=True, slots=True)
class Stop:
    """Stand until `Resume`."""

    command_id: str
    teacher: str


@dataclass(frozen=True, slots=True)
class Resume:
    """Drive again after `Stop`, or after the guard latched an emergency stop."""

    command_id: str
    teacher: str


Command = Teach | Correct | ReplaceAction | DeleteRla | SetPhase | Stop | Resume


@dataclass(frozen=True, slots=True)
class CommandResult:
    """What became of a command in the tick that took it. A lesson is safe only once the journal says so as well."""

    command_id: str
    accepted: bool
    text: str
    """What was done, or why not and what to do."""
