"""What is to be recorded of a run, and the recorder that does it."""

from collections.abc import Callable
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from hal.robot_settings import RobotSettings
from hal.simulation import SimulatedWorld
from kurt2rt.core.decision.active_stop import ActiveStop
from kurt2rt.core.decision.standing_text import stop_text
from kurt2rt.core.perception.definition import load_situation
from kurt2rt.core.task_settings import TaskSettings
from kurt2rt.knowledge.exchange.attachments import collect_attachments, hash_attachments
from kurt2rt.knowledge.journal.loading import OpenedKnowledge
from kurt2rt.runs.recording.live_view import LiveView
from kurt2rt.runs.recording.recorder import RunRecorder, open_run_recorder
from kurt2rt.runs.recording.run_files import Budget
from kurt2rt.runs.recording.run_folder import run_name
from kurt2rt.runs.recording.run_head import RunHead


@dataclass(frozen=True, slots=True)
class RunContext:
    """How a run began."""

    boot: str
    """Names this start of the program, hexadecimal."""
    knowledge: str
    """File that is taught into, also as seen from the working folder; empty where there is none."""
    attended: bool
    stopped: ActiveStop | None = None
    """The stop that holds until the robot is told to resume; None if none does."""
    behaviour: str = ""
    """The taught behaviour that is wanted at first."""
    asked: bool = True
    tolerates_stalls: bool = False


@dataclass(frozen=True, slots=True)
class Recording:
    """Where a run is recorded to, and who may look on."""

    recordings: Path | None
    """Folder of all runs; None: nothing is kept."""
    budget: Budget
    bus: str
    """sim, or the bus that the robot is on."""
    ground: SimulatedWorld | None = None
    """Of a simulated robot."""
    live: tuple[str, int] | None = None
    """Host and port of a live view; None: there is none."""
    tell: Callable[[str], None] = lambda _: None
    """Takes lines for the user, also from another thread."""

    def recorder(
        self,
        settings: RobotSettings,
        task: TaskSettings,
        knowledge: OpenedKnowledge | None,
        circumstances: RunContext,
        *,
        started: datetime | None = None,
    ) -> RunRecorder:
        """The recorder of one run, to be made before its first tick; not started yet.

        `knowledge`: as it is at the start; None: nothing is known. `started`: for a run in simulated time, which then
        begins there; None: now. Raises SettingsError, KnowledgeError.
        """
        entries = () if knowledge is None else knowledge.entries
        attachments = collect_attachments(settings, task, entries, None if knowledge is None else knowledge.saved)
        began = started or datetime.now(UTC)
        head = RunHead(
            kurt2rt=version("kurt2rt"),
            boot=circumstances.boot,
            started_at=began.isoformat(timespec="milliseconds"),
            task=task.name,
            robot=settings.name,
            bus=self.bus,
            knowledge=str(Path(circumstances.knowledge).resolve()) if circumstances.knowledge else "",
            attended=circumstances.attended,
            asked=circumstances.asked,
            stopped=stop_text(circumstances.stopped),
            behaviour=circumstances.behaviour,
            fingerprints=hash_attachments(attachments),
            tolerates_stalls=circumstances.tolerates_stalls,
        )
        return open_run_recorder(
            self.recordings,
            head,
            attachments,
            self.budget,
            settings,
            load_situation(task.situation, settings.infrared.names).names,
            name=run_name(began, task.name),
            live=self.live,
            opened=self._opened,
            ground=self.ground,
            began_at_ns=None if started is None else round(started.timestamp() * 1_000_000_000),
        )

    def ended(self, recorder: RunRecorder) -> None:
        """Tell what came of it; after its end."""
        if recorder.trouble:
            self.tell(recorder.trouble)
        if recorder.run is not None:
            self.tell(f"the run is recorded in {recorder.run}")

    def _opened(self, view: LiveView) -> None:
        self.tell(f"a live view for Foxglove is on {view.address}")
