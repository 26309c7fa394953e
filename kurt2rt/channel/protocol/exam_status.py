"""Status of the exam of a simulated robot, as sent to its teachers."""

from dataclasses import dataclass
from typing import Annotated

from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import Line, Share, Title, Truth, UpTo


@dataclass(frozen=True, slots=True)
class WorldVerdict:
    """Result of the exam in one world."""

    world: Title
    passed: Truth
    text: Line
    """Progress compared with the teacher's own policy, collisions, early end."""
    judged: Truth = True
    """False if the teacher's own policy makes no progress in this world; `passed` means nothing then."""


@dataclass(frozen=True, slots=True)
class ExamStatus:
    """Exam under way, or the newest one."""

    running: Truth
    share: Share
    """Fraction of the robot time that is over, 0 to 1."""
    text: Line
    """Present drive, or the verdict in a sentence; empty before the first exam."""
    verdicts: Annotated[tuple[WorldVerdict, ...], UpTo(32)] = ()
    """One verdict per world; empty until the exam is over."""
    picture: Title = ""
    """Name of the PNG file, to be fetched as `/file`; empty until it is drawn."""
    trouble: Line = ""
    """Reason of a missing verdict in a line; empty without error."""


NO_EXAM = ExamStatus(False, 0.0, "")

EXAM = Codec[ExamStatus]("the exam", ExamStatus)
