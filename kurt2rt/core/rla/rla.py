"""Rule-like association (RLA), the origin of its action, and the training phases."""

from dataclasses import dataclass
from enum import IntEnum

from kurt2rt.core.rla.condition import Condition, pack_condition


class Phase(IntEnum):
    """One of five steps from supervision to autonomy (paper, section IV).

    1 answers, 2 corrections, 3 rewards, 4 a critic is taught, 5 without a teacher. The teacher sets it by `SetPhase`;
    each lesson stores the phase that it was given in.
    """

    SUPERVISED = 1
    CORRECTIONS = 2
    REINFORCEMENT = 3
    CRITIC = 4
    AUTONOMOUS = 5


AUTONOMOUS = Phase.AUTONOMOUS
"""A name for each tick, because Python 3.11 looks a member up in its enumeration ten times slower than a global."""


ASK = "ask"
"""Action of an RLA whose action was withdrawn: the robot asks. No repertoire has this name."""

BASIC = "basic"
"""Level whose RLAs drive the wheels."""

MID = "mid"
"""Level whose RLAs choose a taught behaviour of the basic level."""

CRITIC = "critic"
"""Level whose RLAs appraise situations instead of a teacher; also the critic's name as a teacher."""


@dataclass(frozen=True, slots=True)
class Origin:
    """Origin of a teaching event: its command, teacher, phase and tick."""

    command_id: str
    """Id of the teacher's command; a repeated id counts once."""
    teacher: str
    phase: Phase
    tick: int
    """Tick of the run in which the command was applied."""


def rla_title(rla_id: int, behaviour: str, level: str = BASIC, image: str = "") -> str:
    """Return the name of an RLA in texts: RLA 17, RLA 17 of turn_left, mid-level RLA 12, RLA 17 mirrored."""
    kind = {BASIC: "RLA", MID: "mid-level RLA", CRITIC: "appraisal RLA"}.get(level, f"{level} RLA")
    title = f"{kind} {rla_id} {image}" if image else f"{kind} {rla_id}"
    return f"{title} of {behaviour}" if behaviour else title


@dataclass(frozen=True, slots=True)
class Rla:
    """Rule-like association (RLA): condition, action and expectation (paper, section III.A).

    Near its condition (distance at most `radius`) the robot does its action. For example RLA 17: in a corner, turn
    left. It never changes: `RlaSystem` replaces it at a lesson. Its expectation E stands in `Statistics` by its id,
    because E changes while the robot drives, and only lessons change knowledge.
    """

    rla_id: int
    """Number in the order of teaching, from 1; of two equally near RLAs the smaller one wins."""
    condition: Condition
    action: str
    """Name in the repertoire of its level, or ASK."""
    radius: float | None
    """Own confidence radius; None: the system's radius."""
    origin: Origin
    """Origin of its present action."""
    behaviour: str = ""
    """Taught behaviour that it belongs to: it answers only while that is active. Empty if the task has only one."""
    level: str = BASIC
    """Level of its condition and action."""
    image: str = ""
    """Name of the `Image` that this is of the RLA of its id, as a match returns it; never stored, empty for the RLA."""

    def __post_init__(self) -> None:
        object.__setattr__(self, "condition", pack_condition(self.condition))

    @property
    def title(self) -> str:
        """Name of the RLA in texts: RLA 17, RLA 17 of turn_left, mid-level RLA 12, RLA 17 mirrored."""
        return rla_title(self.rla_id, self.behaviour, self.level, self.image)

    @property
    def key(self) -> tuple[int, str]:
        """Id and name of the image: what tells apart the RLAs that a match compares."""
        return self.rla_id, self.image

    @property
    def is_withdrawn(self) -> bool:
        """Return whether the RLA's action was withdrawn: inside its radius the robot asks."""
        return self.action == ASK


AUTO = "auto"
"""Scripted teacher on its own device."""
SCRIPTED = "scripted teacher"
"""Scripted teacher of an experiment, in the robot's process."""
PROGRAMS = frozenset({AUTO, SCRIPTED, CRITIC})
"""Teachers in a journal that are programs."""
