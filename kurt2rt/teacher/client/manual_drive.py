"""The teacher's presence and the hand at the wheels: a stream of small messages of which the newest counts."""

from collections import deque
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

from kurt2rt.channel.protocol.codec import WireError, decode_answer, encode_request
from kurt2rt.channel.protocol.requests import DriveRequest, StreamRequest, WatchRequest
from kurt2rt.channel.protocol.state import State
from kurt2rt.core.rla.outcome import Outcome, RefusalCode
from kurt2rt.teacher.client.answer import Answer, answer_of, local_refusal
from kurt2rt.teacher.client.link_quality import LinkMeter
from kurt2rt.teacher.client.state_stream import StateStream
from kurt2rt.teacher.client.transport import Exchange, OscoreRequests, Response

BEAT_S = 0.02
"""Between two messages. The robot lets go of the wheels 0.24 s after the last one that it took: at 30 % loss each way
and 50 messages a second a run of lost ones that long comes once in hours, at 20 a second several times a minute."""
BLIND_AFTER_S = 0.5
"""Nothing is sent on a picture that came longer ago than this."""
_FORGOTTEN_AFTER_S = 1.0
"""An answer that comes later is none."""


@dataclass(slots=True)
class _Press:
    hold: int
    boot: bytes
    left_m_s: float
    right_m_s: float
    taken: int = -1
    """Number of the newest message that the robot took."""


@dataclass(slots=True)
class _Sent:
    number: int
    at_s: float
    boot: bytes
    press: _Press | None
    exchange: Exchange | None = None
    answered: bool = False


class ManualDrive:
    """Says that the teacher is there while he is in charge and watches, and drives while a press is on."""

    def __init__(
        self,
        name: str,
        pictures: StateStream,
        requests: OscoreRequests,
        *,
        now: Callable[[], float],
        on_begin: Callable[[], None],
    ) -> None:
        """`name` is the teacher's; `now` is a monotonic clock in seconds; `on_begin` is called as a press begins."""
        self.watching = True
        """Whether the teacher looks at the robot."""
        self.refusal: Answer | None = None
        """Why the last press was not begun, or ended by itself; None while all is well."""
        self.meter = LinkMeter()
        self._name = name
        self._pictures = pictures
        self._requests = requests
        self._now = now
        self._on_begin = on_begin
        self._press: _Press | None = None
        self._under_way: deque[_Sent] = deque()

    @property
    def pressing(self) -> bool:
        """Whether a press is on."""
        return self._press is not None

    @property
    def hold(self) -> int | None:
        """Number of the press that is on."""
        return None if self._press is None else self._press.hold

    def press(self, left_m_s: float, right_m_s: float) -> bool:
        """Begin a press, or change the speeds of the one that is on; whether one is on now.

        Raises WireError for speeds that no robot takes.
        """
        state = self._fresh_picture()
        if state is None:
            self.end(local_refusal("stale", Outcome(RefusalCode.NO_PICTURE)))
            return False
        press = self._press
        begins = press is None
        if press is None:
            press = _Press(self._requests.next_number, state.boot, left_m_s, right_m_s)
        encode_request(_drive(press, state.tick, left_m_s, right_m_s))
        press.left_m_s, press.right_m_s = left_m_s, right_m_s
        if begins:
            self._on_begin()
            self.refusal = None
            self._press = press
            self.beat()
        return self.pressing

    def end(self, because: Answer | None = None) -> None:
        """End the press; nothing more of it is sent. `because`: why a press ends by itself."""
        self._press = None
        self.refusal = because

    def beat(self) -> None:
        """Send what is due; call it every BEAT_S."""
        self._forget_old_ones()
        state = self._fresh_picture()
        press = self._press
        if press is None:
            if state is not None and self.watching and state.teacher == self._name:
                self._send_watch(state)
        elif state is None:
            self.end(local_refusal("stale", Outcome(RefusalCode.PICTURE_LOST)))
        elif state.boot != press.boot:
            self.end(local_refusal("boot", Outcome(RefusalCode.RESTARTED_MEANWHILE)))
        else:
            self._send_drive(press)

    def forget(self) -> None:
        """End the press, and wait for no answer any more."""
        self.end(self.refusal)
        while self._under_way:
            self._end_exchange(self._under_way.popleft())

    def _fresh_picture(self) -> State | None:
        return self._pictures.newest if self._pictures.age_s <= BLIND_AFTER_S else None

    def _send_watch(self, state: State) -> None:
        self._send(WatchRequest(boot=state.boot, seen=self._pictures.heard_tick), None)

    def _send_drive(self, press: _Press) -> None:
        self._send(_drive(press, self._pictures.heard_tick, press.left_m_s, press.right_m_s), press)

    def _send(self, request: StreamRequest, press: _Press | None) -> None:
        sent = _Sent(self._requests.next_number, self._now(), request.boot, press)
        self._under_way.append(sent)
        sent.exchange = self._requests.post(request.path, encode_request(request), partial(self._on_response, sent))

    def _on_response(self, sent: _Sent, response: Response) -> None:
        sent.answered = True
        self.meter.answer(self._now() - sent.at_s)
        try:
            answer = answer_of(response.code, decode_answer(response.payload) if response.payload else {})
        except WireError as error:
            self.end(local_refusal("malformed", Outcome.of(RefusalCode.NOT_UNDERSTOOD, says=str(error))))
            return
        if answer.accepted:
            self._pictures.hear(sent.boot, answer.tick)
        press = sent.press
        if press is None or press is not self._press:
            return
        if answer.accepted:
            press.taken = max(press.taken, sent.number)
        # One that was late on its way is refused, too; the press goes on while newer ones are taken.
        elif sent.number > press.taken and answer.why != "old":
            self.end(answer)

    def _forget_old_ones(self) -> None:
        before_s = self._now() - _FORGOTTEN_AFTER_S
        while self._under_way and (self._under_way[0].answered or self._under_way[0].at_s < before_s):
            sent = self._under_way.popleft()
            if not sent.answered:
                self.meter.silence()
            self._end_exchange(sent)

    def _end_exchange(self, sent: _Sent) -> None:
        if sent.exchange is not None:
            sent.exchange.end()


def _drive(press: _Press, seen: int, left_m_s: float, right_m_s: float) -> DriveRequest:
    return DriveRequest(boot=press.boot, seen=seen, hold=press.hold, left_m_s=left_m_s, right_m_s=right_m_s)
