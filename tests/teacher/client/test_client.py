"""A teacher's device over real sockets and real keys, against a robot whose mind is the test's."""

import asyncio
import time
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import anyio
import pytest

from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.limits import VERSION
from kurt2rt.channel.protocol.requests import (
    CommandRequest,
    LessonsRequest,
    PlaceRequest,
    SaveRequest,
    StopRequest,
    WorldRequest,
)
from kurt2rt.channel.security.pairing import Pairing, pair, renew
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal
from kurt2rt.core.decision.goal import PartialGoal
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import MID, Phase
from kurt2rt.core.teaching.commands import (
    Correct,
    Drive,
    Pursue,
    Resume,
    RunBehaviour,
    Seek,
    SetPhase,
    Single,
    SingleCommand,
    Take,
    Teach,
    Undo,
    Watch,
)
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import Answer, NoAnswer, NoAnswerError, local_refusal
from tests.channel.lossy_link import LossyLink, Weather
from tests.patience import PATIENCE_S, eventually
from tests.teacher.stand_in_robot import (
    SlowMind,
    StandInRobot,
    agrees,
    in_a_task_of_its_own,
    looks_at,
    stand_in_robot,
)
from tests.teacher.states_of import state_where


def open_exchanges(client: TeacherClient) -> int:
    """Return the number of requests and observations that still wait for a message."""
    return len(client._open.requests._coap.request_interfaces[0].outgoing_requests)


HELD = Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher="Ann")


_LONGEST_STEP_S = 0.05


class Clock:
    """A clock that can be put forward. A client reads it 50 times a second: longer steps are stalls of the machine.

    They count as 50 ms, or the client would end a press because its picture is half a second old.
    """

    def __init__(self) -> None:
        self.ahead_s = 0.0
        self._now_s = self._read_s = time.monotonic()

    def __call__(self) -> float:
        read_s = time.monotonic()
        self._now_s += min(read_s - self._read_s, _LONGEST_STEP_S)
        self._read_s = read_s
        return self._now_s + self.ahead_s


@pytest.fixture
async def robot(pairing: Pairing) -> AsyncIterator[StandInRobot]:
    async with in_a_task_of_its_own(stand_in_robot(pairing.teacher.parent)) as robot:
        yield robot


@pytest.fixture
async def link(robot: StandInRobot) -> AsyncIterator[LossyLink]:
    """Return the link between `robot` and `client`; it loses nothing until the test says so."""
    async with LossyLink(robot.port) as link:
        yield link


@pytest.fixture
def clock() -> Clock:
    """Return the clock of `client`."""
    return Clock()


@pytest.fixture
async def client(pairing: Pairing, link: LossyLink, clock: Clock) -> AsyncIterator[TeacherClient]:
    opened = TeacherClient(pairing.device.folder, port=link.port, patience_s=PATIENCE_S, now=clock)
    async with in_a_task_of_its_own(opened) as client:
        await state_where(client)
        yield client


async def more_pictures(client: TeacherClient, robot: StandInRobot) -> None:
    """Let pictures come for longer than a command waits before it is sent again."""
    told = robot.state.tick
    await state_where(client, lambda state: state.tick > told + 20)


def wait_for_answers(client: TeacherClient, seconds: float = PATIENCE_S) -> None:
    """Let a client wait so long for its answers from now on; by default as long as a busy machine takes."""
    client._open.sender.patience_s = seconds


async def be_taught_by(teacher: str, client: TeacherClient, robot: StandInRobot) -> None:
    robot.show(teacher=teacher)
    await state_where(client, teacher=teacher)


# Seeing


async def test_doubled_and_overtaken_pictures_never_go_back_in_time(client: TeacherClient, link: LossyLink) -> None:
    link.down.weather = Weather(doubled=0.5, overtaken=0.5, overtaken_s=0.12)
    ticks = []
    async for state in client.states():
        ticks.append(state.tick)
        if len(ticks) == 12:
            break
    assert ticks == sorted(set(ticks))


async def test_hello_of_other_version_raises_with_remedy(client: TeacherClient, robot: StandInRobot) -> None:
    async def speaks_otherwise(_: object) -> Reply:
        # The missing keys must not be what is complained of.
        return Reply(ReplyStatus.DONE, {"v": VERSION + 1})

    robot.mind = speaks_otherwise
    said = f"speaks version {VERSION + 1} of the wire contract, .* install the same kurt2rt on both"
    with pytest.raises(NoAnswerError, match=said):
        await client.hello()


async def test_correct_earlier_counts_driven_time_alone(client: TeacherClient, robot: StandInRobot) -> None:
    robot.showing = False
    first = robot.state.tick
    pictures = []
    for after, speed_m_s in ((0, 0.3), (50, 0.3), (52, 0.0), (6000, 0.0), (6002, 0.3)):
        robot.state = replace(robot.state, tick=first + after)
        pictures.append(await looks_at(client, robot, left_m_s=speed_m_s, right_m_s=speed_m_s))
    await client.correct_earlier("spin_left", 0.10)
    (correction,) = await robot.hears(Correct)
    assert correction.decision_tick == pictures[0].tick + 42


@pytest.mark.parametrize("seconds", [-0.1, 60.1, float("nan")])
async def test_correct_earlier_beyond_what_is_kept_raises(client: TeacherClient, seconds: float) -> None:
    with pytest.raises(ValueError, match="60 s"):
        await client.correct_earlier("spin_left", seconds)


async def test_lessons_and_world_come_as_values(client: TeacherClient, robot: StandInRobot) -> None:
    async def tells(request: object) -> Reply:
        if isinstance(request, LessonsRequest):
            return Reply(ReplyStatus.DONE, {"lessons": [["phone-01", "RLA 7: forward", "phone", 1, 42, "", False]]})
        corners = [[0.0, 0.0], [1.0, 0.0]]
        world = {"version": 3, "name": "A", "size": [3, 4], "outline": corners, "walls": [["north", corners]]}
        return Reply(ReplyStatus.DONE, {**world, "round": [["pillar", 1.0, 2.0, 0.1]]})

    robot.mind = tells
    assert await client.lessons(5) == (LessonLine("phone-01", "RLA 7: forward", "phone", 1, 42, "", False),)
    world = await client.world()
    assert world is not None
    assert (world.version, world.walls[0].name, world.round[0].radius_m) == (3, "north", 0.1)
    assert robot.orders() == [LessonsRequest(5), WorldRequest()]


# Commands


async def test_each_command_says_on_which_picture_it_was_given(client: TeacherClient, robot: StandInRobot) -> None:
    picture = await looks_at(client, robot)
    expected: list[tuple[type[Any], dict[str, Any]]] = [
        (Teach, {"action": "turn_left", "decision_tick": 88, "level": MID, "alternative": True}),
        (Undo, {"lesson": "phone-01"}),
        (Seek, {"goal": PartialGoal((("x_m", 1.5),), 0.25)}),
        (Take, {}),
        (SaveRequest, {"label": "after lunch"}),
        (PlaceRequest, {"x_m": 1.0, "y_m": 2.0, "heading_rad": 0.5}),
    ]
    for kind, fields in expected:
        await client.send(kind, **fields)
    await client.run("quarter_turn_left", seconds=3.0)
    expected.append((RunBehaviour, {"action": "quarter_turn_left", "ticks": 300}))
    heard = [each for each in robot.orders() if isinstance(each, CommandRequest | SingleCommand)]
    for (kind, fields), each in zip(expected, heard, strict=True):
        assert isinstance(each, kind)
        assert {name: getattr(each, name) for name in fields} == fields
        assert getattr(each, "seen", getattr(each, "seen_tick", picture.tick)) == picture.tick
    assert len({each.command_id for each in heard}) == len(heard)


async def test_while_answers_are_lost_the_same_command_is_sent_again(
    client: TeacherClient, robot: StandInRobot, link: LossyLink
) -> None:
    link.down.weather = Weather(loss=1.0)
    teaching = asyncio.create_task(client.send(Teach, action="forward"))
    await robot.hears(Teach, 3, copies=True)
    assert not teaching.done()
    link.down.weather = Weather()
    assert (await teaching).accepted
    copies = robot.all_of(Teach, copies=True)
    assert set(copies) == {copies[0]}


async def test_before_the_first_picture_nothing_is_sent(pairing: Pairing) -> None:
    async with (
        stand_in_robot(pairing.teacher.parent, showing=False) as robot,
        TeacherClient(pairing.device.folder, port=robot.port, patience_s=0.1) as client,
    ):
        with pytest.raises(NoAnswerError) as caught:
            await client.send(Teach, action="forward")
        assert caught.value.code is NoAnswer.NO_STATE
        assert robot.heard == []
        wait_for_answers(client)
        assert (await client.stop()).accepted


# Presence


async def test_presence_is_not_sent_without_charge_or_watching(client: TeacherClient, robot: StandInRobot) -> None:
    async def says_nothing() -> None:
        await client.stop()  # once it is answered, all that was said before it has been heard
        told = len(robot.all_of(Watch))
        await more_pictures(client, robot)
        await client.stop()
        assert len(robot.all_of(Watch)) == told

    await be_taught_by("phone", client, robot)
    await robot.hears(Watch)
    client.watching = False
    await says_nothing()
    client.watching = True
    await robot.hears(Watch, len(robot.all_of(Watch)) + 1)
    await be_taught_by("laptop", client, robot)
    await says_nothing()


# Stopping


MOVING: dict[str, tuple[type[Single], Callable[[TeacherClient], Awaitable[Answer]]]] = {
    "resume": (Resume, lambda client: client.send(Resume)),
    "forward": (RunBehaviour, lambda client: client.run("forward", seconds=1.0)),
    "phase": (SetPhase, lambda client: client.send(SetPhase, phase=Phase.AUTONOMOUS)),
    "take": (Take, lambda client: client.send(Take)),
    "pursue": (Pursue, lambda client: client.send(Pursue, behaviour="turn_left")),
}


@pytest.mark.parametrize("what", MOVING)
async def test_stop_ends_moving_commands_under_way(client: TeacherClient, robot: StandInRobot, what: str) -> None:
    kind, say = MOVING[what]
    robot.mind = SlowMind(kind)
    moving = asyncio.ensure_future(say(client))
    await robot.hears(kind, 2, copies=True)
    assert (await client.stop()).accepted
    assert await moving == local_refusal(RefusalCode.STOPPED_MEANWHILE, command=what)
    sent = len(robot.all_of(kind, copies=True))
    await more_pictures(client, robot)
    assert len(robot.all_of(kind, copies=True)) == sent
    assert isinstance(robot.orders()[-1], StopRequest)


async def test_a_stop_leaves_a_lesson_that_is_under_way(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = mind = SlowMind(Teach)
    teaching = asyncio.create_task(client.send(Teach, action="forward"))
    await robot.hears(Teach)
    await client.stop()
    mind.may_answer.set()
    assert (await teaching).accepted


async def test_resume_after_own_stop_names_the_stops_tick(client: TeacherClient, robot: StandInRobot) -> None:
    stopped_tick = (await looks_at(client, robot)).tick + 3

    async def stops_later(request: object) -> Reply:
        return done(stopped_tick if isinstance(request, StopRequest) else stopped_tick + 20)

    robot.mind = stops_later
    await client.stop()
    await client.send(Resume)
    await client.send(Teach, action="forward")
    # Other answers do not show that another teacher stopped the robot meanwhile.
    await client.send(Resume)
    resumes = robot.all_of(Resume)
    assert [each.seen_tick for each in resumes] == [stopped_tick, stopped_tick]
    assert robot.all_of(Teach)[0].seen_tick == stopped_tick + 20


async def test_stop_unanswered_is_resent_until_answered(
    client: TeacherClient, robot: StandInRobot, link: LossyLink
) -> None:
    wait_for_answers(client, 0.15)
    tasks_before = len(asyncio.all_tasks())
    link.cut()
    for _ in range(3):
        with pytest.raises(NoAnswerError) as caught:
            await client.stop()
        assert caught.value.code is NoAnswer.STOP_UNANSWERED
        assert client.stop_pending
    assert len(asyncio.all_tasks()) == tasks_before + 1
    assert robot.all_of(StopRequest) == []
    link.mend()
    await eventually(lambda: not client.stop_pending)
    assert len(robot.all_of(StopRequest)) == 1
    await eventually(lambda: len(asyncio.all_tasks()) <= tasks_before)


async def test_stop_unanswered_keeps_limited_copies(
    client: TeacherClient, link: LossyLink, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kurt2rt.teacher.client.request_sender.RESEND_S", 0.001)
    wait_for_answers(client, 0.05)
    link.cut()
    with pytest.raises(NoAnswerError):
        await client.stop()
    lost = link.up.lost
    await link.until(lambda: link.up.lost > lost + 200)
    assert client.stop_pending
    assert open_exchanges(client) <= 35 + 2  # and two of the observation


@pytest.mark.parametrize("wish", ["resume", "run", "press"])
async def test_stop_unanswered_is_superseded_by_later_command(
    client: TeacherClient, robot: StandInRobot, wish: str
) -> None:
    robot.mind = SlowMind(StopRequest)
    wait_for_answers(client, 0.15)
    with pytest.raises(NoAnswerError):
        await client.stop()
    assert client.stop_pending
    wait_for_answers(client)
    if wish == "resume":
        assert (await client.send(Resume)).accepted
    elif wish == "run":
        assert (await client.run("forward", seconds=1.0)).accepted
    else:
        assert client.press(0.1, 0.1)
        await robot.hears(Drive)
    assert not client.stop_pending
    stops = len(robot.all_of(StopRequest, copies=True))
    await more_pictures(client, robot)
    assert len(robot.all_of(StopRequest, copies=True)) == stops


# Driving


async def test_let_go_ends_press_before_its_answer(client: TeacherClient, robot: StandInRobot) -> None:
    robot.mind = mind = SlowMind(StopRequest)
    client.press(0.2, 0.2)
    first = client._drive.press_id
    letting_go = asyncio.create_task(client.let_go())
    await robot.hears(StopRequest)
    assert not client.pressing
    assert client.press(0.1, 0.1)
    await robot.hears(StopRequest, 3, copies=True)
    assert client.pressing
    second = client._drive.press_id
    assert first is not None
    assert second is not None
    assert second > first
    assert {each.press_id for each in robot.all_of(StopRequest)} == {first}
    mind.may_answer.set()
    assert await letting_go is not None
    await client.stop()
    assert robot.all_of(StopRequest)[-1].press_id is None


async def test_driving_block_after_stop_leaves_next_press_alone(client: TeacherClient, robot: StandInRobot) -> None:
    async with client.driving() as wheel:
        assert wheel.set((0.2, 0.2))
        await client.stop()
        assert client.press(0.1, 0.1)
    assert client.pressing
    assert [each.press_id for each in robot.all_of(StopRequest)] == [None]
    await client.let_go()


async def test_press_id_grows_across_restarts_and_renewals(pairing: Pairing) -> None:
    teachers, devices = pairing.teacher.parent, pairing.device.folder.parent
    heard: list[Drive] = []
    for new_keys in (False, False, True):
        if new_keys:
            # A start reserves 1000 numbers, each worth a millisecond: the pairing has to be older than that.
            await anyio.sleep(max(0.0, max(each.press_id for each in heard) / 1000.0 - time.time() + 0.01))
            renew(teachers, devices, "phone")
        async with (
            stand_in_robot(teachers) as robot,
            TeacherClient(pairing.device.folder, port=robot.port, now=Clock()) as client,
        ):
            await state_where(client)
            for _ in range(2):
                before = len(robot.all_of(Drive))
                client.press(0.1, 0.1)
                await robot.hears(Drive, before + 1)
                await client.let_go()
            heard += robot.all_of(Drive)
    holds = list(dict.fromkeys(each.press_id for each in heard))
    assert len(holds) == 6
    assert holds == sorted(holds)


async def test_a_driving_block_ends_with_a_stop(client: TeacherClient, robot: StandInRobot) -> None:
    async with client.driving() as wheel:
        assert wheel.set((0.2, 0.2))
        await robot.hears(Drive, 2)
        assert wheel.set((0.1, 0.2))
    released = robot.heard[-1]
    assert isinstance(released, StopRequest)
    assert released.press_id == wheel.press_id == robot.all_of(Drive)[-1].press_id
    assert not wheel.set((0.2, 0.2))
    assert wheel.ended is not None
    assert wheel.ended.code is RefusalCode.PRESS_OVER


async def test_driving_block_cancelled_stops(client: TeacherClient, robot: StandInRobot) -> None:
    async def drive() -> None:
        async with client.driving() as wheel:
            wheel.set((0.2, 0.2))
            await anyio.sleep_forever()

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(drive)
        await robot.hears(Drive)
        tasks.cancel_scope.cancel()
    assert isinstance(robot.heard[-1], StopRequest)


async def test_a_client_that_ends_while_a_press_is_on_stops_the_robot(pairing: Pairing, robot: StandInRobot) -> None:
    async def drive() -> None:
        async with TeacherClient(pairing.device.folder, port=robot.port, now=Clock()) as client:
            await state_where(client)
            client.press(0.2, 0.2)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        await drive()
    released = robot.heard[-1]
    assert isinstance(released, StopRequest)
    assert released.press_id == robot.all_of(Drive)[-1].press_id


@pytest.mark.parametrize("why", ["stopped", "stale"])
async def test_a_refused_press_ends_and_says_why(client: TeacherClient, robot: StandInRobot, why: str) -> None:
    async def refuses(request: object) -> Reply:
        if isinstance(request, Drive):
            return refusal(why, HELD, 5)
        return await agrees(request)

    robot.mind = refuses
    async with client.driving() as wheel:
        assert wheel.set((0.2, 0.2))
        await eventually(lambda: not client.pressing)
        assert client.refusal is not None
        assert (client.refusal.why, client.refusal.outcome) == (why, HELD)
        assert wheel.ended == client.refusal
        assert not wheel.set((0.2, 0.2))
    assert robot.all_of(StopRequest) == []


async def test_press_continues_if_only_late_message_is_refused(client: TeacherClient, robot: StandInRobot) -> None:
    late = anyio.Event()

    async def refuses_the_first_one_late(request: object) -> Reply:
        if request == robot.all_of(Drive)[0]:
            await late.wait()
            return refusal("stale", Outcome(RefusalCode.OLD_PICTURE), 5)
        if request == robot.all_of(Drive)[1]:
            return refusal("old", Outcome(RefusalCode.OVERTAKEN), 5)
        return await agrees(request)

    robot.mind = refuses_the_first_one_late
    client.press(0.2, 0.2)
    # On a busy machine the refusal would else overtake the answers to newer messages.
    await eventually(lambda: client._drive._press is not None and client._drive._press.accepted >= 0)
    late.set()
    await robot.hears(Drive, 10)
    assert client.pressing
    await client.let_go()


async def test_a_press_ends_when_no_picture_comes_for_half_a_second(
    client: TeacherClient, robot: StandInRobot, clock: Clock
) -> None:
    robot.showing = False
    client.press(0.2, 0.2)
    await robot.hears(Drive)
    clock.ahead_s += 0.6
    await eventually(lambda: not client.pressing)
    assert client.refusal is not None
    assert client.refusal.outcome == Outcome(RefusalCode.PICTURE_LOST)
    driven = len(robot.all_of(Drive))
    assert not client.press(0.2, 0.2)
    assert await client.let_go() is None
    await client.stop()
    assert len(robot.all_of(Drive)) == driven


# The robot and the link


async def test_client_after_robot_restart_proves_itself_and_goes_on(pairing: Pairing, clock: Clock) -> None:
    teachers = pairing.teacher.parent
    async with AsyncExitStack() as first_start:
        robot = await first_start.enter_async_context(in_a_task_of_its_own(stand_in_robot(teachers)))
        async with TeacherClient(pairing.device.folder, port=robot.port, now=clock) as client:
            await state_where(client)
            assert client.press(0.2, 0.2)
            await robot.hears(Drive)
            await first_start.aclose()
            async with stand_in_robot(teachers, port=robot.port, boot=b"next") as robot:
                clock.ahead_s += 1.5
                await state_where(client, boot=b"next")
                assert client.restarts == 1
                assert not client.pressing
                assert (await client.send(Teach, action="forward")).accepted
                boots = list(zip(robot.heard, robot.boots, strict=True))
                assert {boot for each, boot in boots if isinstance(each, Teach)} == {b"next"}
                assert {boot for each, boot in boots if isinstance(each, Drive)} <= {b"boot"}


async def test_robot_without_pairing_is_told_from_silence(tmp_path: Path) -> None:
    stranger = pair(tmp_path / "others", tmp_path / "strangers", "phone")
    async with forger(unauthorised) as port, TeacherClient(stranger.device.folder, port=port, patience_s=0.1) as client:
        await eventually(lambda: client.trouble != "")
        with pytest.raises(NoAnswerError, match="kurt2rt pair"):
            await client.stop()


@pytest.mark.parametrize("option", [b"", b"\x01\x05", b"\x07" + b"\xff" * 7, b"\x29\x01"])
async def test_forged_answer_is_dropped(pairing: Pairing, option: bytes) -> None:
    async with (
        forger(lambda request: changed(request, option)) as port,
        TeacherClient(pairing.device.folder, port=port, patience_s=0.1) as client,
    ):
        with pytest.raises(NoAnswerError):
            await client.stop()
        await eventually(lambda: client._open.requests.damaged >= 1)


def unauthorised(request: bytes) -> bytes:
    """Return a plain 4.01, the answer to an unknown device."""
    return head_of_answer(request, 0x81)


def changed(request: bytes, option: bytes) -> bytes:
    """Return a 2.04 that pretends to be protected."""
    return head_of_answer(request, 0x44) + bytes([0x90 | len(option)]) + option + b"\xffforged, and not even long"


def head_of_answer(request: bytes, code: int) -> bytes:
    confirmable = request[0] & 0x30 == 0
    token = request[4 : 4 + (request[0] & 0x0F)]
    kind = 0x60 if confirmable else 0x50
    return bytes([kind | len(token), code]) + request[2:4] + token


class Forger(asyncio.DatagramProtocol):
    """Answers every datagram with one of its own making."""

    def __init__(self, forge: Callable[[bytes], bytes]) -> None:
        self._forge = forge
        self._transport: asyncio.DatagramTransport | None = None

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._transport = cast(asyncio.DatagramTransport, transport)

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        assert self._transport is not None
        self._transport.sendto(self._forge(data), addr)


@asynccontextmanager
async def forger(forge: Callable[[bytes], bytes]) -> AsyncIterator[int]:
    transport, _ = await asyncio.get_running_loop().create_datagram_endpoint(
        lambda: Forger(forge), local_addr=("127.0.0.1", 0)
    )
    yield transport.get_extra_info("sockname")[1]
    transport.close()


async def test_on_an_old_picture_nothing_is_said(client: TeacherClient, robot: StandInRobot, clock: Clock) -> None:
    await be_taught_by("phone", client, robot)
    await robot.hears(Watch)
    robot.showing = False
    clock.ahead_s += 0.6
    await client.stop()
    told = len(robot.all_of(Watch))
    await client.stop()
    assert len(robot.all_of(Watch)) == told
