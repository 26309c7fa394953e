"""Ways of messages on which they are lost, doubled, late, out of order, old or nonsense."""

import random
from collections.abc import Callable, Hashable, Iterable
from typing import Generic, TypeVar

from tests.stories.fault import FaultInjection
from tests.stories.table import Fault, Target

Message = TypeVar("Message")

SHARE = 0.3
"""Share of the messages that a poor link loses, doubles, garbles or repeats."""
_OLD_S = 2.0
"""Longest time after which a message is replayed."""
_ROUNDING_S = 1e-9


class PoorLink(Generic[Message]):
    """Way of messages through a part that may fail.

    off, intermittent, page_dies, unplugged, restart: none passes. lost: some do not. doubled: some pass twice.
    replayed: some again much later. reordered: each takes a random time, and may overtake. slow: few. delayed: all are
    late, in order, and the end of the fault delivers the rest. What is false, and what a part does besides, is up to
    `instead`.
    """

    def __init__(
        self,
        injection: FaultInjection,
        target: Target,
        chance: random.Random,
        instead: Callable[[Fault, Message, Message], Iterable[Message]],
        *,
        jitters: bool = False,
    ) -> None:
        """Begin with nothing on the way.

        `instead`: what arrives under a fault in place of a message, told with the newest one before the fault.
        `jitters`: whether delays are random, of the same mean.
        """
        self.late: list[Message] = []
        """Messages on the way."""
        self.newest: dict[Hashable, Message] = {}
        """Newest message of each key that passed without a fault."""
        self._injection, self._time, self._target = injection, injection.time, target
        self._chance, self._instead, self._jitters = chance, instead, jitters
        self._passed_at_s: dict[Hashable, float] = {}
        self._due_s: dict[Hashable, float] = {}

    def carry(self, message: Message, deliver: Callable[[Message], None], key: Hashable = None) -> None:
        """Deliver a message as the fault says. `key`: what it is about; it keeps order with those of the same one."""
        fault, now_s, chance = self._injection.acting_on(self._target), self._time.now_s(), self._chance
        if fault is None:
            self.newest[key] = message
            deliver(message)
            return
        chosen = chance.random() < SHARE
        match fault.kind:
            case "off" | "intermittent" | "page_dies" | "unplugged" | "restart":
                return
            case "lost" if chosen:
                return
            case "slow":
                if now_s - max(self._passed_at_s.get(key, 0.0), fault.begin_s) <= fault.period_s - _ROUNDING_S:
                    return
                self._passed_at_s[key] = now_s
            case "delayed":
                late_s = now_s + fault.delay_s * (chance.uniform(0.0, 2.0) if self._jitters else 1.0)
                self._due_s[key] = min(max(late_s, self._due_s.get(key, 0.0)), fault.end_s)
                self._deliver_at(self._due_s[key], message, deliver)
                return
            case "reordered":
                self._deliver_at(now_s + chance.uniform(0.0, fault.delay_s), message, deliver)
                return
            case "replayed" if chosen:
                self._deliver_at(now_s + chance.uniform(0.0, _OLD_S), message, deliver)
            case "doubled" if chosen:
                deliver(message)
        for each in self._instead(fault, message, self.newest.get(key, message)):
            deliver(each)

    def _deliver_at(self, due_s: float, message: Message, deliver: Callable[[Message], None]) -> None:
        def arrive() -> None:
            self.late.remove(message)
            deliver(message)

        self.late.append(message)
        self._time.at(due_s, arrive)
