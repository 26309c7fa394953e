"""Explains the newest decision of a robot that runs, when somebody asks."""

from typing import Any

from kurt2rt.explain.collecting import StampOf, facts_of
from kurt2rt.explain.plain import MOST_OTHERS, plain_of_facts
from kurt2rt.runtime import Runtime
from kurt2rt.tick import TickRecord


class Explaining:
    """Keeps the newest tick, and looks into it on demand: once for each tick, however many ask."""

    def __init__(self, runtime: Runtime, stamp_of: StampOf) -> None:
        """`stamp_of`: when the lesson of a command became durable."""
        self._runtime = runtime
        self._stamp_of = stamp_of
        self._newest: TickRecord | None = None
        self._told: dict[str, Any] | None = None

    def follow(self, record: TickRecord) -> None:
        """Every tick; costs next to nothing."""
        self._newest, self._told = record, None

    def tell(self) -> dict[str, Any] | None:
        """The facts of the newest decision as plain values; None before the first tick. To be called between ticks."""
        if self._told is None and self._newest is not None:
            self._told = plain_of_facts(facts_of(self._runtime, self._newest, self._stamp_of, most=MOST_OTHERS))
        return self._told
