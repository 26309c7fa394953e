"""Stories of a teacher behind a bad link, in simulated time: what counts, what does not, and when the wheels stand."""

import asyncio
import itertools
import random
import signal
from collections import Counter
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import anyio
import pytest

from kurt2rt.channel.protocol.requests import CommandRequest, Request, TickRequest
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.outcome import ResultCode
from kurt2rt.core.rla.events import TeachingEvent
from kurt2rt.core.teaching.commands import Command, ReplaceAction, Resume, Reward, Take, Teach
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import Answer, NoAnswerError
from kurt2rt.teacher.client.transport import Exchange, OnResponse
from tests.channel.bad_links import BAD_LINKS, BadLink
from tests.channel.jumping_loop import run_jumping
from tests.channel.lossy_link import LossyLink, Weather
from tests.channel.robot_at_work import REACH_TICKS, RobotAtWork, journal_of, robot_at_work
from tests.cli.helpers import ROOT, Running, running

_LONGEST_S = 60.0
"""Longest wait for an event, in simulated seconds."""
_HELD_S = 6.0
_HOLE_S = 2.0
_BEAT_S = 0.1


@dataclass(frozen=True, slots=True)
class Length:
    """Durations of the parts of a story, in simulated seconds."""

    lessons_s: float
    driving_s: float


SHORT = Length(lessons_s=3.0, driving_s=1.5)
LONG = Length(lessons_s=8.0, driving_s=20.0)


@dataclass
class Note:
    """One command, and what the teacher was told of it."""

    request: Request
    answer: Answer | None = None
    """None: no answer came."""


class NotingTeacher(TeacherClient):
    """Notes each command with its id, and the robot's tick at which each message of a stream was sent."""

    def __init__(self, at_work: RobotAtWork, link: LossyLink) -> None:
        super().__init__(at_work.pairing.device.folder, port=link.port, now=asyncio.get_running_loop().time)
        self.notes: list[Note] = []
        self.sent_ticks: list[int] = []
        self._at_work = at_work

    def note_what_is_sent(self) -> None:
        requests, sender = self._open.requests, self._open.sender
        post, send = requests.post, sender.send

        async def noted_send(request: Request, patience_s: float | None = None) -> Answer:
            note = Note(request)
            self.notes.append(note)
            note.answer = await send(request, patience_s)
            return note.answer

        def noted(path: str, payload: bytes, on_response: OnResponse) -> Exchange:
            if path in ("/watch", "/drive", "/hold"):
                self.sent_ticks.append(self._at_work.tick)
            return post(path, payload, on_response)

        requests.post = noted  # type: ignore[method-assign]
        sender.send = noted_send  # type: ignore[method-assign]

    def die(self) -> None:
        """Kill its program: nothing leaves it any more, no last message either."""
        self._open.requests._robot = None


class Story:
    """A teacher who teaches and drives over one bad link."""

    def __init__(self, at_work: RobotAtWork, link: LossyLink, teacher: NotingTeacher, bad: BadLink) -> None:
        self.notes = teacher.notes
        self.false_stops = 0
        self._at_work = at_work
        self._link = link
        self._teacher = teacher
        self._bad = bad
        self._now = asyncio.get_running_loop().time
        self._chance = random.Random(bad.seed)

    async def tell(self, length: Length) -> None:
        await self._begin()
        async with self._a_hole_in_the_middle(length.lessons_s):
            await self._teach(length.lessons_s)
        await self._drive_by_hand(length.driving_s)
        await self._drive_by_rlas(length.driving_s)
        await self._is_cut_off_while_driving_by_hand()
        # It still thinks that the button is down when it goes on; the robot knows that this press is over.
        await self._freezes_after(self._press_until_it_drives)
        await self._freezes_after(self._until_rlas_drive)
        if self._bad.holds_back:
            await self._dies_while_all_he_says_is_held_back()
        else:
            await self._dies()

    async def _begin(self) -> None:
        await self._insist(lambda: self._teacher.send(Take))
        await self._insist(lambda: self._teacher.send(Teach, action="forward"))

    async def _insist(self, say: Callable[[], Any]) -> None:
        """Say it until it is accepted."""
        with anyio.fail_after(_LONGEST_S):
            while True:
                try:
                    if (await say()).accepted:
                        return
                except NoAnswerError:
                    pass

    async def _teach(self, lasts_s: float) -> None:
        teacher, until_s = self._teacher, self._now() + lasts_s
        number = 0
        while self._now() < until_s:
            number += 1
            state = teacher.state
            assert state is not None
            try:
                if state.stopped:
                    await teacher.send(Resume)
                match number % 3:
                    case 0:
                        self._at_work.robot.counts = self._chance.randrange(60, 560)
                        await teacher.send(Teach, action=self._chance.choice(("forward", "back", "spin_left")))
                    case 1:
                        await teacher.send(Reward, value=1)  # blame would have the robot ask, and stand
                    case _:
                        await teacher.send(
                            ReplaceAction, rla_id=self._chance.randint(1, state.rlas + 1), action="spin_right"
                        )
            except NoAnswerError:
                pass
            await anyio.sleep(0.05)

    @asynccontextmanager
    async def _a_hole_in_the_middle(self, lasts_s: float) -> AsyncIterator[None]:
        async with anyio.create_task_group() as tasks:
            if self._bad.hole:
                tasks.start_soon(self._hole, lasts_s / 2)
            yield

    async def _hole(self, after_s: float) -> None:
        await anyio.sleep(after_s)
        self._link.cut()
        await anyio.sleep(_HOLE_S)
        await self._mend()

    async def _mend(self) -> None:
        self._link.mend()
        before = self._teacher._stream.count
        await self._at_work.until(lambda: self._teacher._stream.count > before)

    async def _drive_by_hand(self, lasts_s: float) -> None:
        await self._press_until_it_drives()
        first = self._at_work.tick
        await self._keep_pressing(lasts_s)
        self.false_stops += self._stops_since(first, (DecisionCause.TEACHER,))
        with anyio.move_on_after(_LONGEST_S):
            await self._insist(self._teacher.stop)

    async def _drive_by_rlas(self, lasts_s: float) -> None:
        await self._until_rlas_drive()
        first, until_s = self._at_work.tick, self._now() + lasts_s
        while self._now() < until_s:
            if self._at_work.records[-1].decision.cause is DecisionCause.STOPPED:
                await self._until_rlas_drive()
            await anyio.sleep(_BEAT_S)
        self.false_stops += self._stops_since(first, (DecisionCause.RLA, DecisionCause.HELD))

    def _stops_since(self, first: int, driving: tuple[DecisionCause, ...]) -> int:
        causes = [record.decision.cause in driving for record in self._at_work.records if record.tick >= first]
        return sum(before and not after for before, after in itertools.pairwise(causes))

    async def _is_cut_off_while_driving_by_hand(self) -> None:
        await self._press_until_it_drives()
        self._link.cut()
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(self._keep_pressing, _HOLE_S)
            await self._must_stand(_HOLE_S)
        await self._mend()
        # What was held back before the cut comes now.
        await self._must_not_move(_HELD_S if self._bad.holds_back else 1.0)

    async def _freezes_after(self, begin: Callable[[], Awaitable[None]]) -> None:
        await begin()
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(self._teacher._drive, "beat", lambda: None)  # its program hangs
            await self._must_stand(1.0)
        await self._must_not_move(1.0)

    async def _dies(self) -> None:
        await self._press_until_it_drives()
        self._teacher.die()
        await self._must_stand(1.0)

    async def _dies_while_all_he_says_is_held_back(self) -> None:
        await self._press_until_it_drives()
        self._link.up.weather = Weather(held_back=1.0, held_back_s=5.0)
        tick = self._at_work.tick
        sent = max(self._teacher.sent_ticks)
        held = len(self._teacher.notes)
        async with anyio.create_task_group() as tasks:
            tasks.start_soon(self._keep_pressing, _HOLE_S)
            with pytest.raises(NoAnswerError):
                await self._teacher.send(Teach, action="back")
        # With nothing newer behind it OSCORE takes what comes now for new: the rules above it have to know better.
        self._teacher.die()
        await anyio.sleep(_HELD_S)
        self._must_have_stood(sent)
        assert self._at_work.moved_since(tick + REACH_TICKS) == []
        (note,) = [note for note in self._teacher.notes[held:] if isinstance(_command(note.request), Teach)]
        assert not self._at_work.runtime.handler.was_handled(_identity(note.request))

    async def _keep_pressing(self, lasts_s: float) -> None:
        until_s = self._now() + lasts_s
        while self._now() < until_s:
            self._teacher.press(0.2, 0.2)
            await anyio.sleep(_BEAT_S)

    async def _press_until_it_drives(self) -> None:
        def drives() -> bool:
            self._teacher.press(0.2, 0.2)
            return self._at_work.records[-1].decision.cause is DecisionCause.TEACHER

        await self._at_work.until(drives)

    async def _until_rlas_drive(self) -> None:
        with anyio.fail_after(_LONGEST_S):
            while self._at_work.records[-1].decision.cause not in (DecisionCause.RLA, DecisionCause.HELD):
                await self._insist(lambda: self._teacher.send(Resume))
                with anyio.move_on_after(0.5):
                    await self._at_work.until(lambda: self._at_work.records[-1].decision.driving)

    async def _must_stand(self, lasts_s: float) -> None:
        """Check that the wheels stop, from the last message to the robot on."""
        sent = max(self._teacher.sent_ticks)
        await anyio.sleep(lasts_s)
        self._must_have_stood(sent)

    def _must_have_stood(self, sent: int) -> None:
        moved = self._at_work.moved_since(sent)
        assert max(moved, default=0) < sent + REACH_TICKS, f"{self._bad.name}: sent in {sent}, moved in {moved}"

    async def _must_not_move(self, lasts_s: float) -> None:
        tick = self._at_work.tick
        await anyio.sleep(lasts_s)
        assert self._at_work.moved_since(tick) == [], self._bad.name


def _command(request: Request) -> Command | None:
    return request.command if isinstance(request, TickRequest) else None


def _identity(request: Request) -> str:
    assert isinstance(request, CommandRequest)
    return f"local-{request.command_id.hex()}"


def _tell(link: BadLink, folder: Path, length: Length) -> Story:
    async def tell() -> Story:
        async with (
            robot_at_work(folder) as at_work,
            LossyLink(at_work.port, up=link.weather, down=link.weather, seed=link.seed) as lossy,
            NotingTeacher(at_work, lossy) as teacher,
        ):
            teacher.note_what_is_sent()
            story = Story(at_work, lossy, teacher, link)
            await story.tell(length)
            assert at_work.channel.failures == 0
            assert at_work.channel.endpoint.counters.failed == 0, at_work.channel.endpoint.newest_failure
            assert at_work.runtime.timer.missed_ticks == 0
            return story

    random.seed(link.seed)  # aiocoap draws message ids and pauses
    return run_jumping(tell)


def _must_agree(notes: list[Note], events: list[TeachingEvent]) -> None:
    """Check that the journal holds the lessons that were acknowledged."""
    written = Counter(event.origin.command_id for event in events)
    lessons = [note for note in notes if isinstance(_command(note.request), Teach | ReplaceAction | Reward)]
    assert set(written) <= {_identity(note.request) for note in lessons}
    assert set(written.values()) <= {1}
    for note in lessons:
        count = written[_identity(note.request)]
        if note.answer is None or note.answer.why == "unsaved":
            assert count <= 1
        elif not note.answer.accepted:
            assert count == 0
        elif "row" in note.answer.extra:
            row = note.answer.extra["row"]
            assert events[row - 1].origin.command_id == _identity(note.request)
        else:
            assert note.answer.outcome is not None
            assert note.answer.outcome.code is ResultCode.RLA_AGREES, note.answer
            assert count == 0


@pytest.mark.parametrize(
    ("link", "length"),
    [
        pytest.param(BAD_LINKS[29], SHORT, id="short"),
        *(pytest.param(link, LONG, id=link.name, marks=pytest.mark.deep) for link in BAD_LINKS),
    ],
)
def test_bad_link_lessons_count_once_and_silence_stops(link: BadLink, length: Length, tmp_path: Path) -> None:
    story = _tell(link, tmp_path, length)
    _must_agree(story.notes, journal_of(tmp_path))
    if link.weather.loss <= 0.3:
        assert story.false_stops <= (0 if link.missing <= 0.3 else 1)
    if link.weather.loss <= 0.1:
        assert all(note.answer is not None for note in story.notes if isinstance(_command(note.request), Reward))


@asynccontextmanager
async def _driver(at_work: RobotAtWork) -> AsyncIterator[Running]:
    """Run a teacher's program that drives, in real time; kill it at the end."""
    words = (str(at_work.pairing.device.folder), str(at_work.port))
    with running(*words, module="tests.channel.driver_process", folder=ROOT) as driver:
        await at_work.until(lambda: bool(at_work.moved_since(at_work.tick - 1)))
        yield driver


async def _must_stand_from(at_work: RobotAtWork, tick: int) -> None:
    """Check that the wheels stand from this tick on, for a second more than the limit."""
    await at_work.until(lambda: at_work.tick >= tick + REACH_TICKS + 100)
    assert at_work.moved_since(tick + REACH_TICKS) == []


@pytest.mark.deep
async def test_hung_or_killed_client_leaves_robot_standing(tmp_path: Path) -> None:
    async with robot_at_work(tmp_path) as at_work:
        async with _driver(at_work) as driver:
            driver.process.send_signal(signal.SIGSTOP)
            # The tick that is next may still hear what was sent before the signal came.
            await _must_stand_from(at_work, at_work.tick + 1)
            driver.process.send_signal(signal.SIGCONT)
            await _must_stand_from(at_work, at_work.tick - REACH_TICKS)
        async with _driver(at_work) as driver:
            driver.process.kill()
            await _must_stand_from(at_work, at_work.tick + 1)
