"""Work after each tick: channel, health, recording, questions, acknowledgements, statistics and status."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from hal import points
from kurt2rt.channel.server.channel import Channel
from kurt2rt.channel.server.state_builder import basic_question
from kurt2rt.core.decision.decision import withdrawn_rla_in
from kurt2rt.core.decision.standing import question_text
from kurt2rt.core.outcome_text import text_of
from kurt2rt.core.perception.sensor_words import words_for
from kurt2rt.core.rla.rla import MID
from kurt2rt.core.teaching.commands import Command
from kurt2rt.core.teaching.question import MidQuestion, Question, ask_the_way
from kurt2rt.core.tick_record import TickRecord
from kurt2rt.knowledge.journal.writer import Acknowledgement
from kurt2rt.platform.gc_control import collect_young
from kurt2rt.runtime import Runtime
from kurt2rt.service.assembly import RobotService
from kurt2rt.service.health.monitor import HealthMonitor

if TYPE_CHECKING:
    from kurt2rt.runs.recording.recorder import RunRecorder

TickCallback = Callable[[TickRecord], Command | None]
"""Gets each tick's record, inside the robot's program; returns a command for the next tick, or None."""


@dataclass(frozen=True, slots=True)
class ProgramStatus:
    """Status of the service after a tick, as the console of the program shows it."""

    record: TickRecord
    runtime: Runtime
    unsaved_lessons: int
    saving_error: str | None
    """Reason why lessons cannot be saved; None if they can."""
    channel_trouble: str
    """Error of the teachers' channel; empty if there is none."""
    recording_trouble: str = ""
    """Error of the recording; empty if there is none."""


@dataclass(frozen=True, slots=True)
class ProgramConsole:
    """Callbacks by which the service tells the program's screen; the loop calls them, so none may wait."""

    status: Callable[[ProgramStatus], None]
    """Called once per status period."""
    question: Callable[[Question | MidQuestion], None]
    """Called as the robot begins to ask, at most once a second: at the border of R it asks for moments at a time."""
    acknowledged: Callable[[Acknowledgement], None]
    """Called with each lesson that is durable, or that can never be, with the reason."""
    taught: Callable[[str], None] = lambda _: None
    """Called with the text of each lesson that is durable."""


class PostTick:
    """Work of the service after each tick: publish, record, ask, acknowledge, save. Nothing here waits."""

    def __init__(
        self,
        service: RobotService,
        console: ProgramConsole,
        *,
        on_tick: TickCallback | None = None,
        channel: Channel | None = None,
        health: HealthMonitor | None = None,
        recorder: "RunRecorder | None" = None,
    ) -> None:
        runtime = self._runtime = service.runtime
        self._writer = service.writer
        self._stamps = service.stamps
        self._console = console
        self._on_tick = on_tick
        self._channel = channel
        self._health = health
        self._recorder = recorder
        self._words = words_for(runtime.robot.infrared)
        self._ticks_per_second = round(1 / runtime.robot.cycle_s)
        settings, period_s = service.settings, runtime.robot.cycle_s
        self._checkpoint_ticks = round(settings.checkpoint_period_s / period_s)
        self._status_ticks = round(settings.status_period_s / period_s)
        self._unsaved: dict[str, str] = {}
        """Texts of lessons that are not durable yet, by command id."""
        self.last: ProgramStatus | None = None
        """Status that the console got last; None before the first."""

    def __call__(self, record: TickRecord) -> None:
        """Process the record of one tick; call it as soon as the wheels have their set points."""
        runtime, ticks = self._runtime, self._runtime.timer.ticks
        runtime.progress.update(record)
        if self._on_tick is not None and (command := self._on_tick(record)) is not None:
            runtime.inbox.put(command)
        self._unsaved |= {each.command_id: text_of(each.outcome) for each in record.results if each.lesson}
        if self._channel is not None:
            self._channel.after_tick(record)
        if self._health is not None:
            self._health.after_tick(record)
        speed = runtime.handler.authority.speed
        saves = ticks % (self._checkpoint_ticks * speed) == 0 or points.happens("statistics are saved now")
        if self._recorder is not None:
            # Before the tick's question and acknowledgements, so that both follow it in the recording.
            self._recorder.on_tick(record, saved=saves)
        if record.question_begins:
            self._ask(record)
        if not points.happens("acknowledgements wait"):
            for acknowledgement in self._writer.acknowledged():
                self.on_acknowledged(acknowledgement)
        if saves:
            self.save_statistics()
        if ticks % (self._status_ticks * speed) == 0:
            self._show_status(record)
        if ticks % self._ticks_per_second == 0:
            collect_young()

    def on_acknowledged(self, acknowledgement: Acknowledgement) -> None:
        """Publish that a lesson is durable, or that it can never be."""
        if acknowledgement.stamped_at:
            self._stamps[acknowledgement.command_id] = acknowledgement.stamped_at
        if self._channel is not None:
            self._channel.on_acknowledged(acknowledgement)
        if self._recorder is not None:
            self._recorder.on_acknowledged(acknowledgement)
        self._console.acknowledged(acknowledgement)
        text = self._unsaved.pop(acknowledgement.command_id, "")
        if text and acknowledgement.error is None:
            self._console.taught(text)

    def save_statistics(self) -> None:
        """Submit counters and values of the RLAs to the journal's thread; never waits.

        Raises KnowledgeError after the journal was closed.
        """
        self._writer.submit_statistics(self._runtime.snapshot())

    def _show_status(self, record: TickRecord) -> None:
        self.last = ProgramStatus(
            record,
            self._runtime,
            self._writer.unwritten,
            self._writer.saving_error,
            "" if self._channel is None else self._channel.trouble,
            "" if self._recorder is None else self._recorder.trouble,
        )
        self._console.status(self.last)

    def _ask(self, record: TickRecord) -> None:
        question = self._question_of(record)
        if self._recorder is not None:
            self._recorder.on_question(question)
        self._console.question(question)

    def _question_of(self, record: TickRecord) -> Question | MidQuestion:
        runtime, match = self._runtime, record.decision.match
        if runtime.mid is not None and record.decision.asks_at == MID:
            return ask_the_way(match, runtime.mid.settings.situation.describe(runtime.mid.vector))
        question = basic_question(runtime, record, self._words)
        if question.doubts:
            return question
        blamed = withdrawn_rla_in(record.decision)
        worth = None if blamed is None else float(runtime.reinforcement.value(blamed))
        return replace(question, worth=worth, touches=question_text(record.standing))
