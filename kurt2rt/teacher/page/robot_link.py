"""What the page's server needs of the robot; kurt2rt.teacher.client.client.TeacherClient is one."""

from collections.abc import AsyncIterator
from typing import Protocol

from kurt2rt.channel.protocol.exam_status import ExamStatus
from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.hello import Hello
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.requests import TABLE
from kurt2rt.channel.protocol.simulation import SimulationView
from kurt2rt.channel.protocol.state import State
from kurt2rt.channel.protocol.world import WorldView
from kurt2rt.core.rla.rla import BASIC, Phase
from kurt2rt.platform.file_part import FilePart
from kurt2rt.runs.explain.facts import DecisionFacts
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.link_quality import LinkQuality


class RobotLink(Protocol):
    """The robot as a teacher's device has it. What asks it for something raises NoAnswerError when nobody answers."""

    @property
    def watching(self) -> bool:
        """Whether somebody looks at the robot: only then is it told that its teacher is there."""
        ...

    @watching.setter
    def watching(self, watching: bool) -> None: ...

    @property
    def state_age_s(self) -> float:
        """How long ago the newest picture came; infinite before the first."""
        ...

    @property
    def link(self) -> LinkQuality:
        """How well the robot is heard."""
        ...

    @property
    def trouble(self) -> str:
        """Why the robot is not heard, as far as the network tells; empty while it is."""
        ...

    def states(self) -> AsyncIterator[State]:
        """Each picture as it comes; a slow reader gets the newest."""
        ...

    @property
    def pressing(self) -> bool:
        """Whether a press is on; a refusal of the robot ends it, and so does a stop."""
        ...

    @property
    def refusal(self) -> Answer | None:
        """Why the last press was not begun, or ended by itself; None while all is well."""
        ...

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press, or change the speeds of the one that is on; whether one is on now."""
        ...

    async def let_go(self) -> Answer | None:
        """End the press with a stop; None when none is on."""
        ...

    async def stop(self) -> Answer:
        """Stand; always allowed."""
        ...

    async def hello(self) -> Hello:
        """What robot this is."""
        ...

    async def health(self) -> HealthReport | None:
        """How its program is; None in its first second."""
        ...

    async def why(self) -> DecisionFacts | None:
        """What its newest decision rests on; None before its first tick."""
        ...

    async def lessons(self, count: int = 10) -> tuple[LessonLine, ...]:
        """The newest lessons, newest first."""
        ...

    async def world(self) -> WorldView | None:
        """The simulated world; None where the robot is a real one."""
        ...

    async def answer(
        self, action: str, *, of: int | None = None, level: str = BASIC, alternative: bool = False
    ) -> Answer:
        """Answer the situation of a picture; `alternative`: next to what is known there."""
        ...

    async def correct(self, action: str, *, of: int | None = None, level: str = BASIC) -> Answer:
        """Another action is right in the situation of a picture."""
        ...

    async def reward(self, value: int, *, of: int | None = None) -> Answer:
        """Praise (+1) or blame (-1)."""
        ...

    async def appraise(self, appraisal: str, *, of: int | None = None) -> Answer:
        """Teach the critic what the situation of a picture was worth."""
        ...

    async def undo(self, lesson: str | None = None) -> Answer:
        """Take a lesson back; None: the last one that still stands."""
        ...

    async def set_phase(self, phase: Phase) -> Answer:
        """Another training phase."""
        ...

    async def pursue(self, behaviour: str) -> Answer:
        """Follow another taught behaviour."""
        ...

    async def name_situation(self, name: str, *, of: int | None = None) -> Answer:
        """Give the situation of a picture a name."""
        ...

    async def situations(self) -> tuple[str, ...]:
        """The names of the situations that have one."""
        ...

    async def seek(self, name: str) -> Answer:
        """Go to a situation that has a name."""
        ...

    async def stop_seeking(self) -> Answer:
        """No goal any more."""
        ...

    async def set_location(self, name: str) -> Answer:
        """The robot was set down at a situation that has a name."""
        ...

    async def begin_session(self, name: str) -> Answer:
        """Teaching begins."""
        ...

    async def end_session(self) -> Answer:
        """Teaching ends."""
        ...

    async def resume(self) -> Answer:
        """Drive again after a stop."""
        ...

    async def take(self) -> Answer:
        """Be the teacher."""
        ...

    async def hand_over(self, to: str | None = None) -> Answer:
        """Be the teacher no longer."""
        ...

    async def save(self, label: str = "") -> Answer:
        """A copy of the knowledge on the robot."""
        ...

    async def export(self, form: str = TABLE) -> Answer:
        """The RLAs as a table on the robot, or with PACKAGE all of the knowledge as one file."""
        ...

    async def examine(self) -> Answer:
        """Examine a copy of the knowledge of a simulated robot."""
        ...

    async def exam(self) -> ExamStatus | None:
        """Return the exam's status; None if the robot is not simulated in its own program."""
        ...

    def file_parts(self, name: str) -> AsyncIterator[FilePart]:
        """The parts of a file that `save` or `export` made. Raises RefusedError where the robot has none such."""
        ...

    async def move_wall(self, name: str, dx_m: float, dy_m: float) -> Answer:
        """Shift a wall of the simulated world, in metres."""
        ...

    async def place(self, x_m: float, y_m: float, heading_rad: float) -> Answer:
        """Put the simulated robot down elsewhere, in metres and radians."""
        ...

    async def put_back(self) -> Answer:
        """Put the simulated robot down where its run began."""
        ...

    async def simulation(self) -> SimulationView | None:
        """Return the simulated world and task; None if the robot is not simulated in its own program."""
        ...

    async def next_run(self, world: str | None = None, task: str | None = None, *, fresh: bool = False) -> Answer:
        """End the present run of a simulated robot and begin the next one."""
        ...

    async def upload(self, upload: bytes, content: bytes) -> None:
        """Bring a file to the robot's memory under a random id. Raises RefusedError."""
        ...

    async def load_upload(self, upload: bytes, sha256: bytes) -> Answer:
        """Begin the next run of a simulated robot with knowledge that was uploaded."""
        ...

    async def set_speed(self, times: int) -> Answer:
        """Let the time of a simulated robot pass so many times as fast as real time."""
        ...
