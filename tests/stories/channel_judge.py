"""Judge of what the robot takes from its teachers' devices, by the messages as they were sent."""

import math
from collections.abc import Iterator

from kurt2rt.channel.protocol.requests import Request, StopRequest, StreamRequest, TickRequest
from kurt2rt.channel.server.reply import Reply, ReplyStatus
from kurt2rt.channel.server.request_handler import Sender
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.teaching.commands import Drive, HoldAction

_STREAM_TICKS, _MOVING_TICKS, _COMMAND_TICKS = 40, 100, 300
"""Greatest ages of the state that a teacher had seen, a second statement of the robot's."""
_PRESS_TICKS = 30
"""Ticks that the robot runs without a message of a press until that is over for certain."""
_REMEMBERED_TICKS = 1000
_NEVER = -1_000_000


class ChannelJudge:
    """Judge of each message that is taken: of this start of the program, new, in order, and of a recent state."""

    def __init__(self) -> None:
        self.problems: list[str] = []
        self.heard_at_s = -math.inf
        """Simulated time at which the newest message that the robot understood arrived there."""
        self.begin_program(b"")

    def begin_program(self, boot: bytes) -> None:
        """Forget what another start of the program took."""
        self._boot = boot
        self._ran, self._ran_at = 0, dict[int, int]()
        self._numbers: dict[str, int] = {}
        self._commands: set[bytes] = set()
        self._presses: dict[str, tuple[int, int]] = {}
        """Newest press of each device, and the ticks that had run at its newest message."""
        self.drove = set[tuple[str, int]]()
        """Devices and presses that drove; one that waits for a resume has not."""
        self._seen = _NEVER

    def on_tick(self, tick: int, *, by_hand: bool) -> None:
        """Count a tick that ran, `by_hand` if a teacher drove; what it missed before counts for no limit."""
        self._ran += 1
        self._ran_at[tick] = self._ran
        self._ran_at.pop(tick - _REMEMBERED_TICKS, None)
        if by_hand:
            self.drove |= {(device, press) for device, (press, _) in self._presses.items()}
            if all(self._ran - ran > _PRESS_TICKS for _, ran in self._presses.values()):
                self.problems.append(f"in tick {tick} it is driven by a hand that is silent")

    @property
    def picture_ticks(self) -> int:
        """Ticks that ran since the newest state that any of the teachers saw whose streams were taken."""
        return self._ran - self._seen

    def on_reply(self, sender: Sender, request: Request, tick: int, reply: Reply) -> None:
        """Judge the reply to a request that arrived when `tick` was the newest."""
        if isinstance(request, StopRequest):
            self._note_number(sender)
        elif reply.status is ReplyStatus.DONE and isinstance(request, StreamRequest | TickRequest):
            where = f"{sender.device}'s {request.command.path} in tick {tick}"
            self.problems += (f"{where}: {each}" for each in self._faults_of(sender, request, tick, reply))

    def _faults_of(
        self, sender: Sender, request: StreamRequest | TickRequest, tick: int, reply: Reply
    ) -> Iterator[str]:
        if isinstance(request, TickRequest):
            if reply.body.get("code") == ResultCode.REPEATED.value or request.command_id in self._commands:
                return
            self._commands.add(request.command_id)
            seen, longest = request.seen, _MOVING_TICKS if request.command.moves else _COMMAND_TICKS
        else:
            seen, longest = request.command.seen_tick, _STREAM_TICKS
            if sender.number <= self._numbers.get(sender.device, 0):
                yield "taken again, or after a newer one"
            self._note_number(sender)
            self._seen = max(self._seen, self._ran_at.get(seen, 0))
            if isinstance(request.command, Drive | HoldAction):
                press, ran = self._presses.get(sender.device, (0, 0))
                drove = press == request.command.press_id and (sender.device, press) in self.drove
                if drove and self._ran - ran > _PRESS_TICKS:
                    yield "taken though its press is over"
                self._presses[sender.device] = request.command.press_id, self._ran
        if request.boot != self._boot:
            yield "taken though it was meant for another start of the program"
        if tick - seen > longest:
            yield f"taken though its teacher saw tick {seen}"

    def _note_number(self, sender: Sender) -> None:
        self._numbers[sender.device] = max(self._numbers.get(sender.device, 0), sender.number)
