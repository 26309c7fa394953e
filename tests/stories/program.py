"""One start of the robot's program in simulated time, with the loop parts of `kurt2rt run` and no thread."""

import random
import traceback
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

from hal.guard_reason import GuardReason
from kurt2rt.channel.protocol.limits import BOOT_BYTES
from kurt2rt.channel.server.channel import Channel
from kurt2rt.core.decision.standing import STARTED
from kurt2rt.core.task_settings import TaskSettings, load_task
from kurt2rt.core.teaching.commands import Command, Take
from kurt2rt.core.teaching.inbox import InboxFullError, PairingRenewed
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.loading import open_for_teaching
from kurt2rt.runs.recording.recorder import RunRecorder
from kurt2rt.runs.recording.recording import Recording, RunContext
from kurt2rt.runs.recording.run_folder import budget_of
from kurt2rt.service.assembly import RunSettings, assemble_service
from kurt2rt.service.post_tick import PostTick, ProgramConsole
from kurt2rt.service.settings import load_service
from tests.stories.can_log import FaultyCanLog
from tests.stories.clock import FaultyClock
from tests.stories.device import TEACHER, Device
from tests.stories.disk import KilledError, KnowledgeFile
from tests.stories.hand import DRIVER, Hand
from tests.stories.level import FaultyLevel
from tests.stories.rig import Rig
from tests.stories.table import Fault
from tests.stories.witness import Witness

TASK: TaskSettings = load_task("wall_following")

_FIRST_DAY = datetime(2000, 1, 1, tzinfo=UTC)
"""Origin of simulated time in the names of recordings and the stamps of lessons."""
_RECORDINGS_MB = 50
_CHECKPOINT_S = 10.0
_STATUS_S = 3600.0
_WRITES_EVERY_TICKS = 10
_POLL_EVERY_TICKS = 1000
"""Period of the recorder's sync; the disk is not faster in simulated time."""
_ENDLESS_S = 1e9
KNOWLEDGE = "robot.knowledge"
KILLS = ("killed", "killed_before_commit", "killed_after_commit")


class Program:
    """Program from start to end: `run`, then `close`. It stands until a teacher resumes it."""

    def __init__(
        self,
        rig: Rig,
        witness: Witness,
        device: Device,
        folder: Path,
        number: int,
        chance: random.Random,
        *,
        task: TaskSettings = TASK,
        records: bool = True,
    ) -> None:
        """Open the knowledge in `folder` and start the driver; `number`: of the start."""
        self.ended_by = ""
        """Error that ended the program; empty without one."""
        self.killed = False
        self.log: FaultyCanLog | None = None
        self._rig, self._witness, self._time, self._device = rig, witness, rig.time, device
        settings = self.robot = rig.settings
        self._number, self._chance, self._period_s = number, chance, settings.cycle_s
        self._commands = 0
        path = folder / KNOWLEDGE
        opened = open_for_teaching(path, settings, task)
        opened.journal.close()
        self.knowledge = KnowledgeFile(path, opened, rig.injection, self._wall_clock)
        witness.begin_program(rig.start_driver())
        self._clock = FaultyClock(rig.injection, lambda: device.waits)
        self.level = FaultyLevel(rig.injection)
        changed = {"knowledge": str(path), "checkpoint_period_s": _CHECKPOINT_S, "status_period_s": _STATUS_S}
        service = load_service().model_copy(update=changed)
        context = RunContext(f"{number:016x}", str(path), attended=True, stopped=STARTED)
        run_settings = RunSettings(settings, task, service)
        self.service = assemble_service(witness, run_settings, opened, self.knowledge.writer, self._clock, context)
        runtime = self.runtime = self.service.runtime
        self.level.inner = runtime.tick._level
        runtime.tick._level = self.level
        self._recorder: RunRecorder | None = None
        if records:
            self._recorder = Recording(folder / "runs", budget_of(_RECORDINGS_MB), "sim").recorder(
                settings, task, opened, context, started=self._wall_time()
            )
            self._recorder.poll()
        boot = number.to_bytes(BOOT_BYTES, "big")
        parts = replace(self.service.channel_dependencies(), boot=boot)
        channel = self._channel = Channel(runtime, cast("Any", None), parts, longest_wait_s=_ENDLESS_S)
        # No socket: devices talk to the handler.
        channel.endpoint = cast("Any", SimpleNamespace(counters=SimpleNamespace(failed=0), newest_failure=""))
        device.connect(channel.handler, boot)
        self.hand = Hand(device, channel.handler, boot, rig.injection, chance)
        console = ProgramConsole(
            status=lambda _: None, question=lambda _: None, acknowledged=self.knowledge.on_acknowledged
        )
        self._post_tick = PostTick(self.service, console, channel=channel, recorder=self._recorder)
        self._begun_s = 0.0

    @property
    def recorded(self) -> Path | None:
        """Folder of the recorded run; None without one."""
        return None if self._recorder is None else self._recorder.run

    async def run(self, teach: Callable[[TickRecord], None], is_over: Callable[[], bool]) -> None:
        """Run the loop as kurt2rt.service.serve does, until `is_over` returns True, or an error or a kill ends it.

        After any error the wheels stop first; `ended_by` tells the error, and nothing is raised.
        """
        runtime = self.runtime

        def after_tick(record: TickRecord) -> None:
            self._after_tick(record)
            teach(record)
            if is_over():
                runtime.scheduler.end()

        try:
            self._begun_s = self._clock.now_s()
            await runtime.scheduler.run(None, after_tick)
        except KilledError:
            self.killed = True
            return
        except Exception as error:  # noqa: BLE001  # whatever a fault raised ends the program, and is judged
            *_, where = traceback.extract_tb(error.__traceback__)
            self.ended_by = f"{error!r} in {Path(where.filename).name}, line {where.lineno}"
        self._witness.emergency_stop(GuardReason.SERVICE_ENDS)

    def close(self) -> list[str]:
        """End driver and files; return complaints about lost lessons and ticks. Raises KnowledgeError."""
        self._device.disconnect()
        self.hand.disconnect()
        self._channel.handler.close()
        self._rig.end_driver(killed=self.killed)
        disk = self._rig.injection.of("disk")
        if disk is not None:  # a program that ends waits for its disk, and none starts without its file
            self._time.run_until(disk.end_s)
        if not self.ended_by and not self.killed:
            self._post_tick.save_statistics()
        recorder, ticks = self._recorder, self.runtime.timer.ticks
        complaints = list(self.knowledge.close(killed=self.killed))
        if recorder is not None:
            recorder.close()
            if recorder.dropped or recorder.written + self.killed < ticks:
                complaints.append(f"of {ticks} ticks {recorder.written} are recorded{recorder.trouble}")
        return complaints

    def begin_fault(self, fault: Fault) -> None:
        """Do what belongs to a fault that begins within half a second: a hand that drives, a log, a lost file."""
        bus = self._rig.ends.bus
        match fault.target, fault.kind:
            case "disk", "wrong":
                self.knowledge.write()
                self.knowledge.take_away(fault)
            case "recorder", _ if bus is not None:
                self.log = FaultyCanLog(self._rig.injection, bus)
            case "teacher_link", _:
                self.put(Take(self.next_id(), DRIVER))
                self.hand.press()
            case "program", kind if kind in KILLS:
                self.knowledge.journal.dies = kind
            case "link", "page_dies":
                self._device.forget()
            case "link", "keys_renewed":
                self.runtime.inbox.put(PairingRenewed(TEACHER))
                self._device.judge.drove.clear()  # a device with new keys counts its presses from 0

    def end_fault(self, fault: Fault) -> list[str]:
        """End a fault that is over; return complaints about its log."""
        if fault.target == "clock":
            self._clock.repair()
        if fault.target == "teacher_link":
            self.hand.let_go()
        if fault.target != "recorder" or self.log is None:
            return []
        log, self.log = self.log, None
        return list(log.finish())

    def set_down(self) -> None:
        """Put the robot where it can drive, as a person does."""
        self._rig.set_down()
        self.runtime.reposition()

    def put(self, command: Command) -> None:
        with suppress(InboxFullError):  # a loop that hangs takes nothing; the teacher says it again
            self.runtime.inbox.put(command)

    def next_id(self) -> str:
        self._commands += 1
        return f"{self._number}-{self._commands}"

    def _after_tick(self, record: TickRecord) -> None:
        runtime, ticks = self.runtime, self.runtime.timer.ticks
        self._witness.on_tick(record, runtime.timer, self._begun_s, self._period_s)
        self.knowledge.submitted += [event.origin.command_id for event in record.events]
        self._post_tick(record)
        self.knowledge.write()
        if self._recorder is not None:
            if ticks % _WRITES_EVERY_TICKS == 0:
                self._recorder.write_waiting()
            if ticks % _POLL_EVERY_TICKS == 0:
                self._recorder.poll()
        self._device.see(record)
        if self.knowledge.journal.dies == "killed":
            raise KilledError

    def _wall_time(self) -> datetime:
        return _FIRST_DAY + timedelta(seconds=self._time.now_s() + self._rig.injection.wall_clock_step_s())

    def _wall_clock(self) -> str:
        return self._wall_time().isoformat(timespec="milliseconds")
