"""Status of the exam of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass

from kurt2rt.channel.protocol.cbor_schema import LINE, NAME, DataclassCodec, MapOf
from kurt2rt.core.teaching.message_fields import Flag, Float, ListOf

_MOST_WORLDS = 32


@dataclass(frozen=True, slots=True)
class WorldVerdict:
    """Result of the exam in one world."""

    world: str
    passed: bool
    text: str
    """Progress compared with the teacher's own policy, collisions, early end."""
    judged: bool = True
    """False if the teacher's own policy makes no progress in this world; `passed` means nothing then."""


@dataclass(frozen=True, slots=True)
class ExamStatus:
    """Exam under way, or the newest one."""

    running: bool
    share: float
    """Fraction of the robot time that is over, 0 to 1."""
    text: str
    """Present drive, or the verdict in a sentence; empty before the first exam."""
    verdicts: tuple[WorldVerdict, ...] = ()
    """One verdict per world; empty until the exam is over."""
    picture: str = ""
    """Name of the PNG file, to be fetched as `/file`; empty until it is drawn."""
    trouble: str = ""
    """Reason of a missing verdict in a line; empty without error."""


NO_EXAM = ExamStatus(False, 0.0, "")

EXAM = DataclassCodec[ExamStatus](
    "the exam",
    MapOf(
        ExamStatus,
        running=Flag(),
        share=Float(1.0),
        text=LINE,
        verdicts=ListOf(MapOf(WorldVerdict, world=NAME, passed=Flag(), text=LINE, judged=Flag()), most=_MOST_WORLDS),
        picture=NAME,
        trouble=LINE,
    ),
)
