"""Whether a run comes out again as it was."""

from collections.abc import Callable
from dataclasses import dataclass

from kurt2rt.runs.replay.comparison import TickDifference, compare
from kurt2rt.runs.replay.replay import Replay, ReplayedTick, empty_run_error
from kurt2rt.runs.replay.run import Run


@dataclass(frozen=True, slots=True)
class ReplayVerdict:
    """What a replay found."""

    ticks: int
    """That came out as they were, from the first on."""
    lasted_s: float
    """Of the runtime's clock, from the first of them to the last."""
    knowledge: int
    """How often the hash of all that is known was compared."""
    differences: tuple[TickDifference, ...]
    """Of the first tick that came out otherwise; after it all else may follow from it."""
    trouble: str
    """Why not the whole run was replayed, in a sentence; empty where it was."""
    whole: bool
    """Whether no tick is missing but at the end."""

    @property
    def same(self) -> bool:
        """Whether everything came out as it was, as far as the run can be replayed."""
        return not self.differences


def verify(run: Run, on_tick: Callable[[ReplayedTick], None] | None = None) -> ReplayVerdict:
    """Replay a run up to the first difference. `on_tick` is called for each tick.

    Raises RecordingError, also for a run without ticks: nothing is the same there.
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
        if on_tick is not None:
            on_tick(tick)
    if not ticks and not differences:
        raise empty_run_error(run)
    return ReplayVerdict(ticks, lasted_s, knowledge, tuple(differences), run.trouble, run.whole)
