"""A robot's mind on ticks that the test makes, with a recorder."""

from collections.abc import Callable
from pathlib import Path

from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.exchange.attachments import collect_attachments, hash_attachments
from kurt2rt.runs.recording.live_view import LiveView
from kurt2rt.runs.recording.recorder import RunRecorder, open_run_recorder
from kurt2rt.runs.recording.recording_disk import Disk
from kurt2rt.runs.recording.run_folder import Budget, budget_of
from kurt2rt.runs.recording.run_head import RecordedRun, RunHead
from simbridge.contracts.simulation import SimulatedWorld
from tests.channel.channel_fixture import ROBOT, TASK, ChannelFixture

BEGAN_AT_NS = 1_795_318_200_000_000_000
NAME = "20261122T031005Z-wall_following"
ATTACHMENTS = collect_attachments(ROBOT, TASK)
HEAD = RunHead(
    kurt2rt="0.1.0",
    boot="626f6f74",
    started_at="2026-11-22T03:10:05+00:00",
    task="wall_following",
    robot=ROBOT.name,
    bus="sim",
    knowledge="",
    attended=True,
    asked=True,
    stopped="",
    behaviour="",
    fingerprints=hash_attachments(ATTACHMENTS),
)


class RecordedDesk:
    """Robot's mind with a recorder. The test decides when the recorder writes, unless it is started."""

    def __init__(
        self,
        recordings: Path | None,
        *,
        disk: Disk | None = None,
        budget: Budget | None = None,
        world: SimulatedWorld | None = None,
        capacity: int = 3000,
        name: str = NAME,
        live: tuple[str, int] | None = None,
        opened: Callable[[LiveView], None] = lambda _: None,
        began_at_ns: int | None = BEGAN_AT_NS,
        polled: bool = True,
    ) -> None:
        """Open the recorder; with `polled`, it has looked at its disk once."""
        self.desk = ChannelFixture()
        self.recorder: RunRecorder = open_run_recorder(
            recordings,
            RecordedRun(
                name, HEAD, ATTACHMENTS, ROBOT, self.desk.runtime.definition.names, world, began_at_ns=began_at_ns
            ),
            budget or budget_of(100),
            live=live,
            opened=opened,
            disk=disk,
            capacity=capacity,
        )
        self.records: list[TickRecord] = []
        if polled:
            self.recorder.poll()

    def run(self, ticks: int, counts: int | None = None) -> None:
        for _ in range(ticks):
            record = self.desk.run(1, counts)
            self.records.append(record)
            self.recorder.on_tick(record)

    def second(self, counts: int | None = None) -> None:
        """Run a second of ticks, and write as the recorder's thread would."""
        self.run(100, counts)
        self.recorder.write_waiting()
        self.recorder.poll()


def late_run(recordings: Path) -> Path:
    """Record a run whose first segments were deleted to make room; return its folder."""
    desk = RecordedDesk(recordings, budget=Budget(75_000, segment_bytes=20_000))
    for second in range(15):
        desk.second(counts=200 + second)
    desk.recorder.close()
    return recordings / NAME


def empty_run(recordings: Path) -> Path:
    """Record a run that ended before its first tick; return its folder."""
    desk = RecordedDesk(recordings)
    desk.recorder.close()
    return recordings / NAME
