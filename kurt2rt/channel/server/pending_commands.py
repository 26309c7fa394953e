"""What became of each command, so that the same one sent again is answered and not carried out again."""

import asyncio
from collections import OrderedDict

from kurt2rt.channel.server.reply import Reply


class PendingCommands:
    """Replies by command id, those that are still to come among them; the oldest settled ones are forgotten."""

    def __init__(self, capacity: int = 1024) -> None:
        self._capacity = capacity
        self._replies: OrderedDict[str, asyncio.Future[Reply]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._replies)

    def get(self, command_id: str) -> asyncio.Future[Reply] | None:
        """The reply to a command that came before, perhaps still to come."""
        return self._replies.get(command_id)

    def begin(self, command_id: str) -> asyncio.Future[Reply]:
        """A command that came for the first time."""
        self._forget()
        reply = self._replies[command_id] = asyncio.get_running_loop().create_future()
        return reply

    def settle(self, command_id: str, reply: Reply) -> None:
        """What became of a command; nothing where it did not come over the network."""
        waiting = self._replies.get(command_id)
        if waiting is not None and not waiting.done():
            waiting.set_result(reply)

    def _forget(self) -> None:
        while len(self._replies) >= self._capacity:
            # What is under way must not be taken for new when it comes again.
            oldest = next((command_id for command_id, reply in self._replies.items() if reply.done()), None)
            if oldest is None:
                return
            del self._replies[oldest]
