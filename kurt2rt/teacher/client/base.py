"""What all parts of a teacher's device share: the connection to its robot, once it is open, and the pictures of it."""

from collections.abc import Callable

from kurt2rt.teacher.client.connection import Connection
from kurt2rt.teacher.client.manual_drive import ManualDrive
from kurt2rt.teacher.client.request_sender import RequestSender
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.stop_sender import StopSender


class ClientBase:
    """Base of the parts of a `TeacherClient`. What asks the robot raises RuntimeError while it is not open."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now` is a monotonic clock in seconds."""
        self._pictures = StateStream(now)
        self._connection: Connection | None = None

    @property
    def _asking(self) -> RequestSender:
        return self._open.asking

    @property
    def _stopping(self) -> StopSender:
        return self._open.stopping

    @property
    def _hand(self) -> ManualDrive:
        return self._open.hand

    @property
    def _open(self) -> Connection:
        if self._connection is None:
            raise RuntimeError("the client is not open; use it as: async with TeacherClient(folder) as robot: ...")
        return self._connection
