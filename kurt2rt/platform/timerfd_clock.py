"""Real time through Linux's timer file descriptor."""

import asyncio
import ctypes
import os
import time
from typing import Self

_TFD_TIMER_ABSTIME = 1
_NANOSECONDS = 1_000_000_000


class _Timespec(ctypes.Structure):
    _fields_ = (("seconds", ctypes.c_long), ("nanoseconds", ctypes.c_long))


class _Itimerspec(ctypes.Structure):
    _fields_ = (("interval", _Timespec), ("value", _Timespec))


class TimerfdClock:
    """Monotonic time with deadlines that the kernel keeps.

    The event loop's own timers are rounded up to whole milliseconds; a timer file descriptor wakes it like any socket.
    Use it inside the running loop, as a context manager.
    """

    def __init__(self) -> None:
        self._libc = ctypes.CDLL(None, use_errno=True)
        self._fd = -1
        self._loop: asyncio.AbstractEventLoop | None = None
        self._fired: asyncio.Future[None] | None = None

    def __enter__(self) -> Self:
        self._fd = self._libc.timerfd_create(time.CLOCK_MONOTONIC, os.O_NONBLOCK | os.O_CLOEXEC)
        if self._fd < 0:
            raise OSError(ctypes.get_errno(), "timerfd_create failed; the runtime needs Linux")
        self._loop = asyncio.get_running_loop()
        # One reader for the whole run: anyio.wait_readable would register and drop it in every tick.
        self._loop.add_reader(self._fd, self._on_readable)
        return self

    def __exit__(self, *_: object) -> None:
        assert self._loop is not None
        self._loop.remove_reader(self._fd)
        os.close(self._fd)

    def now_s(self) -> float:
        """Return monotonic time in s."""
        return time.monotonic()

    async def wait_until(self, deadline_s: float) -> None:
        """Return at the deadline, some 0.1 ms late; at once if it has passed. Raises OSError."""
        if deadline_s <= time.monotonic():
            # One turn for other tasks: a loop that is always late must not starve the channel.
            await asyncio.sleep(0)
            return
        assert self._loop is not None
        self._fired = self._loop.create_future()
        seconds, fraction = divmod(round(deadline_s * _NANOSECONDS), _NANOSECONDS)
        setting = _Itimerspec(_Timespec(0, 0), _Timespec(seconds, fraction))
        if self._libc.timerfd_settime(self._fd, _TFD_TIMER_ABSTIME, ctypes.byref(setting), None) != 0:
            raise OSError(ctypes.get_errno(), "timerfd_settime failed")
        await self._fired

    def _on_readable(self) -> None:
        try:
            os.read(self._fd, 8)
        except BlockingIOError:
            return  # armed again between the wake-up and this call
        if self._fired is not None and not self._fired.done():
            self._fired.set_result(None)
