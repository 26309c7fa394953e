"""Deadman stream of a teacher's device: presence messages, and the press of a drive or a hold while one is on."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import anyio

from kurt2rt.channel.protocol.codec import decode_answer, encode_request, path_of
from kurt2rt.channel.protocol.requests import StreamRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.message_fields import WireError
from kurt2rt.core.outcome import RefusalCode
from kurt2rt.core.teaching.commands import Drive, HoldAction, Watch
from kurt2rt.teacher.client.answer import Answer, answer_of, local_refusal
from kurt2rt.teacher.client.link_quality import LinkMeter
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import Exchange, OscoreRequests, Response

BEAT_S = 0.02
"""Period of the stream. The robot stops 0.24 s after the last message that it accepted. At 30 % loss each way, a run of
lost messages that long comes once in hours at 50 messages a second, and several times a minute at 20."""
BLIND_AFTER_S = 0.5
"""Age of the newest state from which on nothing is sent."""
_POLL_S = 0.05
_TIMEOUT_S = 1.0
"""Time after which an answer no longer counts."""


Wish = tuple[float, float] | str
"""Content of a press: speeds of the wheels (left, right) in m/s, or an action that is held."""


@dataclass(slots=True)
class _Press:
    press_id: int
    boot: bytes
    wish: Wish
    accepted: int = -1
    """Number of the newest message that the robot accepted."""


@dataclass(slots=True)
class _Sent:
    number: int
    at_s: float
    boot: bytes
    press: _Press | None
    exchange: Exchange | None = None
    answered: bool = False


class ManualDrive:
    """Teleoperation by one device: sends the press that drives, and the teacher's presence between presses.

    Each hold has a press id, so a late stop of an earlier hold does not end this one.

    A press drives by speeds, or holds an action, which teaches (hold to correct).
    """

    def __init__(
        self,
        name: str,
        stream: StateStream,
        requests: OscoreRequests,
        *,
        now: Callable[[], float],
        on_begin: Callable[[], None],
    ) -> None:
        """Begin without a press.

        Args:
            name: of the teacher.
            stream: states of the robot.
            requests: to the robot.
            now: monotonic clock in seconds, also for the time of a press.
            on_begin: called as a press with speeds begins.
        """
        self.watching = True
        """Whether the teacher looks at the robot."""
        self.refusal: Answer | None = None
        """Refusal that ended the last press, or kept it from beginning; None if there is none."""
        self.meter = LinkMeter()
        self._name = name
        self._stream = stream
        self._requests = requests
        self.now_s = now
        self._on_begin = on_begin
        self._press: _Press | None = None
        self._under_way: deque[_Sent] = deque()

    @property
    def press_id(self) -> int | None:
        """Number of the press that is on; None if none is."""
        return None if self._press is None else self._press.press_id

    def press(self, wish: Wish) -> bool:
        """Begin a press, or change the speeds or the action of the present one; return whether a press is on.

        Raises WireError for speeds out of range, and for a name that cannot be sent.
        """
        state = self._fresh_state()
        if state is None:
            self.end(local_refusal(RefusalCode.NO_PICTURE))
            return False
        press = self._press
        begins = press is None or isinstance(press.wish, str) != isinstance(wish, str)
        if press is None or begins:
            press = _Press(self._requests.next_number, state.boot, wish)
        encode_request(_message(press, state.tick, wish))
        press.wish = wish
        if begins:
            if not isinstance(wish, str):  # a hold does not let a stopped robot drive, so a stop goes on being sent
                self._on_begin()
            self.refusal = None
            self._press = press
            self.beat()
        return self._press is not None

    def end(self, refusal: Answer | None = None) -> None:
        """End the press and send nothing more of it; `refusal` is the reason if the teacher did not end it."""
        self._press = None
        self.refusal = refusal

    def beat(self) -> None:
        """Send the message that is due, of the press or of presence; call it every BEAT_S."""
        self._drop_timed_out()
        state = self._fresh_state()
        press = self._press
        if press is None:
            if state is not None and self.watching and state.teacher == self._name:
                self._send(StreamRequest(state.boot, Watch("", self._stream.newest_tick)), None)
        elif state is None:
            self.end(local_refusal(RefusalCode.PICTURE_LOST))
        elif state.boot != press.boot:
            self.end(local_refusal(RefusalCode.RESTARTED_MEANWHILE))
        else:
            self._send(_message(press, self._stream.newest_tick, press.wish), press)

    def close(self) -> None:
        """End the press and drop the answers that are still to come."""
        self.end(self.refusal)
        while self._under_way:
            self._end_exchange(self._under_way.popleft())

    def _fresh_state(self) -> State | None:
        return self._stream.newest if self._stream.age_s <= BLIND_AFTER_S else None

    def _send(self, request: StreamRequest, press: _Press | None) -> None:
        sent = _Sent(self._requests.next_number, self.now_s(), request.boot, press)
        self._under_way.append(sent)
        sent.exchange = self._requests.post(path_of(request), encode_request(request), partial(self._on_response, sent))

    def _on_response(self, sent: _Sent, response: Response) -> None:
        sent.answered = True
        self.meter.on_answer(self.now_s() - sent.at_s)
        try:
            answer = answer_of(response.code, decode_answer(response.payload) if response.payload else {})
        except WireError as error:
            self.end(local_refusal(RefusalCode.NOT_UNDERSTOOD, says=str(error)))
            return
        if answer.accepted:
            self._stream.on_answer(sent.boot, answer.tick)
        press = sent.press
        if press is None or press is not self._press:
            return
        if answer.accepted:
            press.accepted = max(press.accepted, sent.number)
        # A message that the network held back is refused too; the press goes on while newer messages are accepted.
        elif sent.number > press.accepted and answer.code is not RefusalCode.OVERTAKEN:
            self.end(answer)

    def _drop_timed_out(self) -> None:
        before_s = self.now_s() - _TIMEOUT_S
        while self._under_way and (self._under_way[0].answered or self._under_way[0].at_s < before_s):
            sent = self._under_way.popleft()
            if not sent.answered:
                self.meter.on_timeout()
            self._end_exchange(sent)

    def _end_exchange(self, sent: _Sent) -> None:
        if sent.exchange is not None:
            sent.exchange.end()


class PressHandle:
    """Handle of one press by a program. It is sent 50 times a second; an ended press stays ended."""

    def __init__(self, drive: ManualDrive) -> None:
        self._drive = drive
        self._press_id: int | None = None
        self.released: Answer | None = None
        """Answer to the end of the press, after a hold with the number of its lessons; None before, and without one."""

    @property
    def press_id(self) -> int | None:
        """Number of the press; None before it begins."""
        return self._press_id

    @property
    def ended(self) -> Answer | None:
        """Refusal that ended the press, PRESS_OVER if another call ended it; None while it is on or not begun."""
        if self._press_id is None or self._drive.press_id == self._press_id:
            return None
        return self._drive.refusal or local_refusal(RefusalCode.PRESS_OVER)

    async def wait(self, seconds: float) -> None:
        """Wait for a time, or until the press is ended by a refusal or another call."""
        ends_s = self._drive.now_s() + seconds
        while self._press_id is not None and self.ended is None:
            left_s = ends_s - self._drive.now_s()
            if left_s <= 0.0:
                return
            await anyio.sleep(min(left_s, _POLL_S))

    def set(self, wish: Wish) -> bool:
        """Begin the press, or change it; return whether it is on. Raises WireError, as `ManualDrive.press`."""
        # An ended press does not begin again by itself: after a pause the teacher may no longer mean it.
        if self._press_id is not None and self._drive.press_id != self._press_id:
            return False
        pressing = self._drive.press(wish)
        if self._press_id is None:
            self._press_id = self._drive.press_id
        return pressing


def _message(press: _Press, seen: int, wish: Wish) -> StreamRequest:
    if isinstance(wish, str):
        return StreamRequest(press.boot, HoldAction("", seen, press.press_id, wish))
    return StreamRequest(press.boot, Drive("", seen, press.press_id, *wish))
