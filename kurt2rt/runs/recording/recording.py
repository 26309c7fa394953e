"""Destination of a run's recording, and the recorder of one run."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING

from config.plugins import loaded_plugins
from config.settings_files import SHIPPED_DIR
from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.standing import ActiveStop
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.attachments import collect_attachments, hash_attachments
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.runs.recording.run_folder import Budget, run_name
from kurt2rt.runs.recording.run_head import RecordedRun, RunHead
from simbridge.contracts.simulation import WorldView

if TYPE_CHECKING:
    from kurt2rt.runs.recording.live_view import LiveView
    from kurt2rt.runs.recording.recorder import RunRecorder

LAYOUT = SHIPPED_DIR / "foxglove" / "kurt2.json"
"""Layout of panels for recordings and live views in Foxglove."""


@dataclass(frozen=True, slots=True)
class RunContext:
    """State of program and robot at the start of a run, recorded so that a replay begins alike."""

    boot: str
    """Identifier of this start of the program, hexadecimal."""
    knowledge: str
    """Knowledge file, relative paths from the working folder; empty without one."""
    attended: bool
    stopped: ActiveStop | None = None
    """Stop that holds until a teacher resumes; None without one."""
    behaviour: str = ""
    """Active taught behaviour at the start."""
    asked: bool = True
    tolerates_stalls: bool = False


@dataclass(frozen=True, slots=True)
class Recording:
    """Destination and limits of a program's recordings; it opens a recorder for each run."""

    recordings: Path | None
    """Folder of all runs; None: no files."""
    budget: Budget
    bus: str
    """sim, or the robot's bus."""
    world: WorldView | None = None
    """World of a simulated robot."""
    live: tuple[str, int] | None = None
    """Host and port of a live view; None: no live view."""
    notify: Callable[[str], None] = lambda _: None
    """Receiver of lines for the user, also from another thread."""

    def recorder(
        self,
        settings: RobotSettings,
        task: TaskSettings,
        knowledge: OpenedKnowledge | None,
        context: RunContext,
        *,
        started: datetime | None = None,
    ) -> "RunRecorder":
        """Return the recorder of one run, not started yet; call it before the first tick.

        `knowledge`: state at the start; None: nothing is known. `started`: beginning of a run in simulated time; None:
        now.

        Raises:
            SettingsError: a file that the task uses cannot be read.
            KnowledgeError: a knowledge file that an action of the task uses cannot be read.
        """
        # Late import: foxglove-sdk is in the extra `recording`, and a robot may do without it.
        from kurt2rt.runs.recording.recorder import open_run_recorder

        entries = () if knowledge is None else knowledge.entries
        attachments = collect_attachments(settings, task, entries, None if knowledge is None else knowledge.saved)
        began = started or datetime.now(UTC)
        head = RunHead(
            kurt2rt=version("kurt2rt"),
            boot=context.boot,
            started_at=began.isoformat(timespec="milliseconds"),
            task=task.name,
            robot=settings.name,
            bus=self.bus,
            knowledge=str(Path(context.knowledge).resolve()) if context.knowledge else "",
            attended=context.attended,
            asked=context.asked,
            stopped=context.stopped.reason if context.stopped is not None else "",
            behaviour=context.behaviour,
            fingerprints=hash_attachments(attachments),
            tolerates_stalls=context.tolerates_stalls,
            plugins={f"{each.group} {each.name}": each.source for each in loaded_plugins()},
        )
        run = RecordedRun(
            name=run_name(began, task.name),
            head=head,
            attachments=attachments,
            settings=settings,
            features=load_situation(task.situation, settings.infrared.names).names,
            world=self.world,
            began_at_ns=None if started is None else round(started.timestamp() * 1_000_000_000),
        )
        return open_run_recorder(self.recordings, run, self.budget, live=self.live, opened=self._opened)

    def report_end(self, recorder: "RunRecorder") -> None:
        """Report the result of a closed recorder to the user."""
        if recorder.trouble:
            self.notify(recorder.trouble)
        if recorder.run is not None:
            self.notify(f"the run is recorded in {recorder.run}")

    def _opened(self, view: "LiveView") -> None:
        self.notify(f"a live view for Foxglove is on {view.address}; import its layout once: {LAYOUT}")
