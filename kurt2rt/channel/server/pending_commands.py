"""Idempotency cache: the reply to each command id, so that a copy is answered and not carried out again."""

import asyncio
from collections import OrderedDict

from kurt2rt.channel.server.reply import Reply


class PendingCommands:
    """Replies by command id, pending ones included; the oldest settled replies are dropped."""

    def __init__(self, capacity: int = 1024) -> None:
        self._capacity = capacity
        self._replies: OrderedDict[str, asyncio.Future[Reply]] = OrderedDict()

    def __len__(self) -> int:
        return len(self._replies)

    def get(self, command_id: str) -> asyncio.Future[Reply] | None:
        """Return the reply to an earlier command, perhaps pending; None for a new command."""
        return self._replies.get(command_id)

    def begin(self, command_id: str) -> asyncio.Future[Reply]:
        """Add a new command and return its pending reply."""
        self._drop_oldest()
        reply = self._replies[command_id] = asyncio.get_running_loop().create_future()
        return reply

    def settle(self, command_id: str, reply: Reply) -> None:
        """Resolve a pending reply; commands that did not come over the network are left out."""
        waiting = self._replies.get(command_id)
        if waiting is not None and not waiting.done():
            waiting.set_result(reply)

    def _drop_oldest(self) -> None:
        while len(self._replies) >= self._capacity:
            # A pending command must not be mistaken for a new one when its copy comes.
            oldest = next((command_id for command_id, reply in self._replies.items() if reply.done()), None)
            if oldest is None:
                return
            del self._replies[oldest]
