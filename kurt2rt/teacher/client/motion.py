"""How a teacher's device moves its robot by itself: a stop, a press, an action for a time."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

import anyio

from kurt2rt.channel.protocol.requests import BehaviourRequest, ResumeRequest
from kurt2rt.teacher.client.answer import Answer
from kurt2rt.teacher.client.manual_drive_handle import ManualDriveHandle
from kurt2rt.teacher.client.state import StateMixin


class MotionMixin(StateMixin):
    """To stop, to let go, to drive by hand. Each raises NoAnswerError when nobody answers."""

    def __init__(self, now: Callable[[], float]) -> None:
        """`now` is a monotonic clock in seconds."""
        super().__init__(now)
        self._period_s: float | None = None

    async def stop(self) -> Answer:
        """Stand; always allowed. A press is over, and what was to move the robot and is not answered yet is sent no
        more: it comes back refused, with the `why` "stopped".

        Raises NoAnswerError as every command does, but goes on being sent then: see `stop_pending`.
        """
        self._hand.end()
        return await self._stopping.stop()

    @property
    def stop_pending(self) -> bool:
        """Whether a stop that was not answered in time is still being sent: until it is, or until the teacher wishes
        something later, which is `resume`, `run` or the begin of a press.
        """
        return self._stopping.pending

    async def resume(self) -> Answer:
        """Drive again after a stop."""
        self._stopping.wish_anew()
        return await self._stopping.move("go", lambda: self._asking.command(ResumeRequest, moves=True))

    async def run(self, action: str, *, seconds: float) -> Answer:
        """Run one action of the repertoire for a time; the robot stands afterwards."""
        self._stopping.wish_anew()

        async def begin() -> Answer:
            if self._period_s is None:
                self._period_s = (await self.hello()).period_s
            ticks = round(seconds / self._period_s)
            return await self._asking.command(BehaviourRequest, moves=True, action=action, ticks=ticks)

        return await self._stopping.move(action, begin)

    @property
    def watching(self) -> bool:
        """Whether the teacher looks at the robot; only then is it told that he is there."""
        return self._hand.watching

    @watching.setter
    def watching(self, watching: bool) -> None:
        self._hand.watching = watching

    @property
    def pressing(self) -> bool:
        """Whether a press is on."""
        return self._hand.pressing

    @property
    def refused(self) -> str:
        """Why the last press was not begun, or ended by itself; empty while all is well."""
        refusal = self._hand.refusal
        return "" if refusal is None else refusal.text or refusal.why

    @property
    def refusal(self) -> Answer | None:
        """Why the last press was not begun, or ended by itself, with its code; None while all is well."""
        return self._hand.refusal

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press or change its speeds; whether one is on. It ends by itself when the robot refuses it, or when
        no picture came for half a second; whoever calls this again then begins another one.

        Raises WireError for speeds that no robot takes.
        """
        return self._hand.press(left_m_s, right_m_s)

    async def let_go(self) -> Answer | None:
        """End the press with a stop that ends no later one; None when none is on.

        The press is over before this waits for anything, and when nobody answers: the robot lets go by itself.
        """
        return await self._open.release(self._hand.hold)

    @asynccontextmanager
    async def driving(self) -> AsyncIterator[ManualDriveHandle]:
        """Drive by hand inside the block; the press begins with the first speeds and ends with a stop."""
        wheel = ManualDriveHandle(self._hand)
        try:
            yield wheel
        except BaseException:
            with anyio.CancelScope(shield=True):
                await self._open.release_anyhow(wheel.hold)
            raise
        await self._open.release(wheel.hold)
