"""The contract of a reference policy."""

from typing import Protocol


class ReferencePolicy(Protocol):
    """Names the right action for what the sensors show now.

    Memoryless, because a robot can only learn from what is in its situation: hidden state in the teacher's head is
    unlearnable.
    """

    def choose(self, infrared_counts: tuple[int, ...], behaviour: str) -> str:
        """Name of the action to take, of the repertoire. `infrared_counts`: as in Senses.

        `behaviour`: the taught behaviour that is wanted, empty where the task has only one.
        """
        ...
