"""Status of the exam of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass

from kurt2rt.channel.protocol.cbor_schema import LINE, NAME, Form, MapOf, MayLack
from kurt2rt.channel.protocol.schema import Flag, Float, ManyOf

_MOST_WORLDS = 32


@dataclass(frozen=True, slots=True)
class WorldVerdict:
    """The exam in one world."""

    world: str
    passed: bool
    text: str
    """Progress next to that of the teacher's own policy, collisions, an early end."""
    judged: bool = True
    """False: the teacher's own policy gets nowhere in this world, and `passed` says nothing."""


@dataclass(frozen=True, slots=True)
class ExamStatus:
    """The exam that is under way, or the newest one."""

    running: bool
    share: float
    """Of the robot time that is over, 0 to 1."""
    text: str
    """The present drive, or the verdict in a sentence; empty before the first exam."""
    verdicts: tuple[WorldVerdict, ...] = ()
    """One per world; empty until the exam is over."""
    picture: str = ""
    """Name of the PNG file, to be fetched as `/file`; empty until it is drawn."""
    trouble: str = ""
    """Why there is no verdict, in a line; empty where nothing went wrong."""


NO_EXAM = ExamStatus(False, 0.0, "")

EXAM = Form[ExamStatus](
    "the exam",
    MapOf(
        ExamStatus,
        running=Flag(),
        share=Float(1.0),
        text=LINE,
        verdicts=ManyOf(
            MapOf(WorldVerdict, world=NAME, passed=Flag(), text=LINE, judged=MayLack(Flag())), most=_MOST_WORLDS
        ),
        picture=NAME,
        trouble=LINE,
    ),
)
