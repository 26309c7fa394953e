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

from kurt2rt.channel.protocol.hello import HELLO, AppraisalName, MidIntroduction
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.limits import VERSION
from kurt2rt.channel.protocol.requests import (
    CommandRequest,
    HelloRequest,
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
from tests.teacher.page.fake_robot import A_HELLO
from tests.teacher.stand_in_robot import StandInRobot, agrees, in_a_task_of_its_own, stand_in_robot


def open_exchanges(client: TeacherClient) -> int:
    """Return the number of requests and observations that still wait for a message."""
    return len(client._open.requests._coap.request_interfaces[0].outgoing_requests)


CRITICS = tuple(AppraisalName(name, value) for name, value in (("bad", -1), ("neutral", 0), ("good", 1)))
MIDS: dict[str, Any] = {"behaviours": ("straight_on", "turn_left"), "mid": MidIntroduction("history", 12, 6.0)}
A_PUPIL = replace(A_HELLO, what="Teach it to follow a wall", appraisals=CRITICS, trusted_from=0.8, seeks=True, **MIDS)
INTRODUCED = Reply(ReplyStatus.DONE, HELLO.plain_of(A_PUPIL))
HELD = Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher="Ann")


LONGEST_S = 60.0
"""Ends a test whose event never comes, and the patience of a client that is answered; none waits for it."""
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
async def client(pairing: Pairing, robot: StandInRobot) -> AsyncIterator[TeacherClient]:
    opened = TeacherClient(pairing.device.folder, port=robot.port, patience_s=LONGEST_S, now=Clock())
    async with in_a_task_of_its_own(opened) as client:
        await first_state(client)
        yield client


async def first_state(client: TeacherClient) -> None:
    await seen(client, lambda: True)


async def seen(client: TeacherClient, holds: Callable[[], bool]) -> None:
    """Wait for a picture with which something holds."""
    with anyio.fail_after(LONGEST_S):
        async for _ in client.states():
            if holds():
                return


async def eventually(holds: Callable[[], bool]) -> None:
    """Wait for a condition that sets no event."""
    with anyio.fail_after(LONGEST_S):
        while not holds():  # noqa: ASYNC110
            await anyio.sleep(0.005)


def be_patient(client: TeacherClient) -> None:
    """Let a client wait for its answers from now on as long as a busy machine takes."""
    client._open.sender.patience_s = LONGEST_S


async def be_in_charge(client: TeacherClient, robot: StandInRobot) -> None:
    robot.show(teacher="phone")
    await seen(client, lambda: client.state is not None and client.state.teacher == "phone")


# Seeing


async def test_doubled_and_overtaken_pictures_never_go_back_in_time(pairing: Pairing, robot: StandInRobot) -> None:
    bad = Weather(doubled=0.5, overtaken=0.5, overtaken_s=0.12)
    ticks = []
    async with LossyLink(robot.port, down=bad) as link, TeacherClient(pairing.device.folder, port=link.port) as client:
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
    async def introduces_itself(request: object) -> Reply:
        return INTRODUCED if isinstance(request, HelloRequest) else await agrees(request)

    robot.mind = introduces_itself
    robot.showing = False
    first = robot.state.tick
    pictures = []
    for after, speed_m_s in ((0, 0.3), (50, 0.3), (52, 0.0), (6000, 0.0), (6002, 0.3)):
        robot.state = replace(robot.state, tick=first + after)
        pictures.append(robot.show(left_m_s=speed_m_s, right_m_s=speed_m_s))
        await seen(client, lambda: client.state == pictures[-1])
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
    async def introduces_itself(request: object) -> Reply:
        return INTRODUCED if isinstance(request, HelloRequest) else await agrees(request)

    robot.mind = introduces_itself
    robot.showing = False
    picture = robot.show()
    await seen(client, lambda: client.state == picture)
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


async def test_while_answers_are_lost_the_same_command_is_sent_again(pairing: Pairing, robot: StandInRobot) -> None:
    async with (
        LossyLink(robot.port) as link,
        TeacherClient(pairing.device.folder, port=link.port) as client,
        anyio.create_task_group() as tasks,
    ):
        await first_state(client)
        link.down.weather = Weather(loss=1.0)
        answers: list[Answer] = []

        async def teach() -> None:
            answers.append(await client.send(Teach, action="forward"))

        tasks.start_soon(teach)
        await robot.hears(Teach, 3, copies=True)
        assert answers == []
        link.down.weather = Weather()
        await eventually(lambda: bool(answers))
        assert answers[0].accepted
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
        be_patient(client)
        assert (await client.stop()).accepted


# Presence


async def test_presence_is_not_sent_without_charge_or_watching(client: TeacherClient, robot: StandInRobot) -> None:
    async def says_nothing() -> None:
        await client.stop()  # once it is answered, all that was said before it has been heard
        told = len(robot.all_of(Watch))
        for _ in range(3):
            newest = robot.show(teacher=robot.state.teacher)
            await seen(client, lambda: client.state is not None and client.state.tick >= newest.tick)  # noqa: B023
        await client.stop()
        assert len(robot.all_of(Watch)) == told

    await be_in_charge(client, robot)
    await robot.hears(Watch)
    client.watching = False
    await says_nothing()
    client.watching = True
    await robot.hears(Watch, len(robot.all_of(Watch)) + 1)
    robot.show(teacher="laptop")
    await seen(client, lambda: client.state is not None and client.state.teacher == "laptop")
    await says_nothing()


# Stopping


async def never_answers(_: object) -> Reply:
    await anyio.sleep_forever()
    raise AssertionError


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

    async def hears_only_stops(request: object) -> Reply:
        if isinstance(request, HelloRequest):
            return INTRODUCED
        return await (never_answers if isinstance(request, kind) else agrees)(request)

    robot.mind = hears_only_stops
    answers: list[Answer] = []

    async def move() -> None:
        answers.append(await say(client))

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(move)
        await robot.hears(kind, 2, copies=True)
        stop = await client.stop()
    assert stop.accepted
    assert answers == [local_refusal(RefusalCode.STOPPED_MEANWHILE, command=what)]
    # Longer than a command waits before it is sent again: four more commands go and come.
    sent = len(robot.all_of(kind, copies=True))
    robot.mind = agrees
    for _ in range(4):
        newest = robot.show()
        await seen(client, lambda: client.state is not None and client.state.tick > newest.tick)  # noqa: B023
    assert len(robot.all_of(kind, copies=True)) == sent
    assert isinstance(robot.orders()[-1], StopRequest)


async def test_a_stop_leaves_a_lesson_that_is_under_way(client: TeacherClient, robot: StandInRobot) -> None:
    stopped = anyio.Event()

    async def answers_lessons_after_the_stop(request: object) -> Reply:
        if isinstance(request, Teach):
            await stopped.wait()
        return await agrees(request)

    robot.mind = answers_lessons_after_the_stop
    answers: list[Answer] = []

    async def teach() -> None:
        answers.append(await client.send(Teach, action="forward"))

    async with anyio.create_task_group() as tasks:
        tasks.start_soon(teach)
        await robot.hears(Teach)
        await client.stop()
        stopped.set()
    assert answers[0].accepted


async def test_resume_after_own_stop_names_the_stops_tick(client: TeacherClient, robot: StandInRobot) -> None:
    robot.showing = False
    picture = robot.show()
    await seen(client, lambda: client.state == picture)
    stopped_tick = picture.tick + 3

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


async def test_stop_unanswered_is_resent_until_answered(pairing: Pairing, robot: StandInRobot) -> None:
    async with (
        LossyLink(robot.port) as link,
        TeacherClient(pairing.device.folder, port=link.port, patience_s=0.15) as client,
    ):
        await first_state(client)
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
    pairing: Pairing, robot: StandInRobot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kurt2rt.teacher.client.request_sender.RESEND_S", 0.001)
    async with (
        LossyLink(robot.port) as link,
        TeacherClient(pairing.device.folder, port=link.port, patience_s=0.05) as client,
    ):
        await first_state(client)
        link.cut()
        with pytest.raises(NoAnswerError):
            await client.stop()
        lost = link.up.lost
        await link.until(lambda: link.up.lost > lost + 200)
        assert client.stop_pending
        assert open_exchanges(client) <= 35 + 2  # and two of the observation


@pytest.mark.parametrize("wish", ["resume", "run", "press"])
async def test_stop_unanswered_is_superseded_by_later_command(pairing: Pairing, robot: StandInRobot, wish: str) -> None:
    async def does_not_hear_stops(request: object) -> Reply:
        if isinstance(request, HelloRequest):
            return INTRODUCED
        return await (never_answers if isinstance(request, StopRequest) else agrees)(request)

    robot.mind = does_not_hear_stops
    async with TeacherClient(pairing.device.folder, port=robot.port, patience_s=0.15, now=Clock()) as client:
        await first_state(client)
        with pytest.raises(NoAnswerError):
            await client.stop()
        assert client.stop_pending
        be_patient(client)
        if wish == "resume":
            assert (await client.send(Resume)).accepted
        elif wish == "run":
            assert (await client.run("forward", seconds=1.0)).accepted
        else:
            assert client.press(0.1, 0.1)
            await robot.hears(Drive)
        assert not client.stop_pending
        stops = len(robot.all_of(StopRequest, copies=True))
        told = robot.state.tick
        await seen(client, lambda: client.state is not None and client.state.tick > told + 20)
        assert len(robot.all_of(StopRequest, copies=True)) == stops


# Driving


async def test_let_go_ends_press_before_its_answer(client: TeacherClient, robot: StandInRobot) -> None:
    async def does_not_answer_stops(request: object) -> Reply:
        return await (never_answers if isinstance(request, StopRequest) else agrees)(request)

    robot.mind = does_not_answer_stops
    client.press(0.2, 0.2)
    first = client._drive.press_id
    async with anyio.create_task_group() as tasks:
        tasks.start_soon(client.let_go)
        await robot.hears(StopRequest)
        assert not client.pressing
        assert client.press(0.1, 0.1)
        await robot.hears(StopRequest, 3, copies=True)
        assert client.pressing
        tasks.cancel_scope.cancel()
    second = client._drive.press_id
    assert first is not None
    assert second is not None
    assert second > first
    assert {each.press_id for each in robot.all_of(StopRequest)} == {first}
    robot.mind = agrees
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
            await first_state(client)
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
            await first_state(client)
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


async def test_a_press_ends_when_no_picture_comes_for_half_a_second(pairing: Pairing, robot: StandInRobot) -> None:
    clock = Clock()
    async with TeacherClient(pairing.device.folder, port=robot.port, now=clock) as client:
        await first_state(client)
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


async def test_client_after_robot_restart_proves_itself_and_goes_on(pairing: Pairing) -> None:
    teachers = pairing.teacher.parent
    clock = Clock()
    async with AsyncExitStack() as first_start:
        robot = await first_start.enter_async_context(in_a_task_of_its_own(stand_in_robot(teachers)))
        async with TeacherClient(pairing.device.folder, port=robot.port, now=clock) as client:
            await first_state(client)
            assert client.press(0.2, 0.2)
            await robot.hears(Drive)
            await first_start.aclose()
            async with stand_in_robot(teachers, port=robot.port, boot=b"next") as robot:
                clock.ahead_s += 1.5
                await seen(client, lambda: client.state is not None and client.state.boot == b"next")
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
async def test_forged_answer_is_dropped(tmp_path: Path, option: bytes) -> None:
    pairing = pair(tmp_path / "teachers", tmp_path / "devices", "phone")
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


async def test_on_an_old_picture_nothing_is_said(pairing: Pairing, robot: StandInRobot) -> None:
    clock = Clock()
    async with TeacherClient(pairing.device.folder, port=robot.port, now=clock) as client:
        await be_in_charge(client, robot)
        await robot.hears(Watch)
        robot.showing = False
        clock.ahead_s += 0.6
        await client.stop()
        told = len(robot.all_of(Watch))
        await client.stop()
        assert len(robot.all_of(Watch)) == told
