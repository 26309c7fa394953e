"""Replay of a recorded run, for scripts and notebooks."""

from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING

from config.errors import UserError
from kurt2rt.library.extras import extra_named
from kurt2rt.runs.explain.reasons import format_decision
from kurt2rt.runs.explain.recorded import explain_run
from kurt2rt.runs.explain.timeline import Stretch, Timeline, build_timeline, format_summary
from kurt2rt.runs.recording.run_folder import find_run, segments_in
from kurt2rt.runs.replay.reader import read_run
from kurt2rt.runs.replay.run import Run
from kurt2rt.runs.replay.verify import ReplayVerdict, verify

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class ReplayedRun:
    """Recorded run after `replay`: whether the replay is equal to it, and its decisions to read and plot."""

    path: Path
    """Folder of the run."""
    run: Run
    verdict: ReplayVerdict
    timeline: Timeline

    @property
    def exact(self) -> bool:
        """Return whether each tick was decided again as it was recorded, bit for bit, and no tick is missing."""
        return self.verdict.same and self.verdict.whole

    @property
    def ticks(self) -> int:
        """Number of equal ticks from the first on."""
        return self.verdict.ticks

    @property
    def difference(self) -> str | None:
        """First difference from the recording; None if the replay is equal to it."""
        return str(self.verdict.differences[0]) if self.verdict.differences else None

    @property
    def decisions(self) -> tuple[Stretch, ...]:
        """Recorded decisions: stretches of the same action or question, with `what`, `from_s` and `to_s`."""
        return self.timeline.stretches

    def why(self, at: float) -> str:
        """Return the decision `at` seconds after the first step, and its reasons, a line each.

        Raises UserError (kurt2rt.Error) for a time outside of the run.
        """
        if not 0.0 <= at <= self.timeline.to_s:
            raise UserError(f"outside of the run (got {at!r}, allowed 0 to {self.timeline.to_s:.2f} s)", where="at")
        return format_decision(explain_run(self.run, at).facts)

    def plot(self) -> "Figure":
        """Return a figure of the run: path, actions, distance of the nearest RLA, speeds."""
        # Late import: matplotlib is an extra that a robot does not need.
        from kurt2rt.runs.explain.timeline_picture import timeline_figure

        return timeline_figure(self.timeline, f"{self.path.name}: {self.run.head.task} on {self.run.head.robot}")

    def __repr__(self) -> str:
        """Return what the robot did, and how the replay ended."""
        ended = f"{self.ticks} ticks were decided again bit for bit"
        if self.difference is not None:
            ended += f"; then {self.difference}"
        return "\n".join(filter(None, [format_summary(self.timeline), ended, self.verdict.trouble]))


def replay(path: str | PathLike[str]) -> ReplayedRun:
    """Decide a recorded run again from its sensor readings and commands, and compare all decisions bit for bit.

    Args:
        path: folder of a run, or of recordings, whose newest run is taken; of `SimulatedRobot(record=...)` or of
            `kurt2rt run`.

    Raises:
        UserError: as kurt2rt.Error, there is no recorded run, or this version cannot replay it.
    """
    given = Path(path)
    with extra_named():
        if given.is_dir() and not segments_in(given):
            given = find_run(None, given)
        run = read_run(given)
    verdict = verify(run)
    known = (lesson.event for lesson in run.lessons)
    return ReplayedRun(given, run, verdict, build_timeline(run.entries(), run.robot, known=known))
