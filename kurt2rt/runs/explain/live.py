"""Facts of the newest decision of a running robot, collected on request."""

from kurt2rt.core.tick import TickRecord
from kurt2rt.runs.explain.collect import StampOf, collect_facts
from kurt2rt.runs.explain.facts import MOST_OTHERS, DecisionFacts
from kurt2rt.runtime import Runtime


class LiveExplainer:
    """Newest tick of a running robot, whose facts are collected at most once per tick."""

    def __init__(self, runtime: Runtime, stamp_of: StampOf) -> None:
        """`stamp_of`: time at which the lesson of a command became durable."""
        self._runtime = runtime
        self._stamp_of = stamp_of
        self._newest: TickRecord | None = None
        self._facts: DecisionFacts | None = None

    def follow(self, record: TickRecord) -> None:
        """Keep the record of a tick. Takes constant time."""
        self._newest, self._facts = record, None

    def facts(self) -> DecisionFacts | None:
        """Return the facts of the newest decision; None before the first tick. Call it between ticks."""
        if self._facts is None and self._newest is not None:
            self._facts = collect_facts(self._runtime, self._newest, self._stamp_of, most=MOST_OTHERS)
        return self._facts
