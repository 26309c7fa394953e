"""Verification that a run replays bit for bit."""

from collections.abc import Callable
from dataclasses import dataclass

from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.replay.comparison import TickDifference, compare
from kurt2rt.runs.replay.replay import Replay, empty_run_error
from kurt2rt.runs.replay.run import Run


@dataclass(frozen=True, slots=True)
class ReplayVerdict:
    """Result of `kurt2rt replay`: number of equal ticks, and the first differences."""

    ticks: int
    """Equal ticks from the first on."""
    lasted_s: float
    """Runtime clock's time from the first of them to the last."""
    knowledge: int
    """Number of compared knowledge hashes."""
    differences: tuple[TickDifference, ...]
    """Differences of the first unequal tick; later ticks may differ as a consequence."""
    trouble: str
    """Reason why part of the run was not replayed, in a sentence; empty if all of it was."""
    whole: bool
    """True if the ticks have no gap before the end."""

    @property
    def same(self) -> bool:
        """Return whether every replayed tick was equal."""
        return not self.differences


def verify(run: Run, on_entry: Callable[[TickEntry], None] = lambda _: None) -> ReplayVerdict:
    """Replay a run up to the first difference, and return the verdict.

    `on_entry` is called for each equal tick. Raises RecordingError, also for a run without ticks.
    """
    ticks = knowledge = 0
    lasted_s = 0.0
    differences: list[TickDifference] = []
    for tick in Replay(run):
        differences = compare(*tick)
        if differences:
            break
        lasted_s = run.elapsed_s(tick.entry)
        ticks += 1
        knowledge += tick.entry.knowledge is not None
        on_entry(tick.entry)
    if not ticks and not differences:
        raise empty_run_error(run)
    return ReplayVerdict(ticks, lasted_s, knowledge, tuple(differences), run.trouble, run.has_no_gap)
