"""TerminalTeacher with a real client, a robot whose answers are the test's, and typed lines."""

import os
import threading
from collections.abc import AsyncIterator
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field

import anyio
import pytest

from config.errors import ExitCode
from kurt2rt.channel.protocol.codec import FACTS
from kurt2rt.channel.protocol.health import HEALTH
from kurt2rt.channel.protocol.lesson_list import LessonLine
from kurt2rt.channel.protocol.requests import (
    HealthRequest,
    HelloRequest,
    LessonsRequest,
    SituationsRequest,
    StopRequest,
    WhyRequest,
)
from kurt2rt.channel.security.pairing import Pairing
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done
from kurt2rt.core.decision.goal import NamedGoal, PartialGoal, RlaGoal
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import (
    Appraise,
    BeAt,
    Correct,
    HoldAction,
    NameSituation,
    Resume,
    Reward,
    Seek,
    SetPhase,
    StopSeeking,
    Take,
    Teach,
)
from kurt2rt.runs.explain.reasons import format_decision
from kurt2rt.teacher import TeacherClient
from kurt2rt.teacher.client.answer import NoAnswer, NoAnswerError
from kurt2rt.teacher.terminal.terminal import TerminalTeacher
from kurt2rt.teacher.terminal.terminal_text import format_critic_change, format_misunderstood, format_opinion
from tests.channel.states import COMMANDS, SURPRISED, state
from tests.patience import PATIENCE_S, eventually
from tests.runs.explain.helpers import facts, level, story
from tests.service.health.reports import ILL
from tests.teacher.client.test_client import Clock, wait_for_answers
from tests.teacher.page.fake_robot import A_HELLO
from tests.teacher.stand_in_robot import (
    CRITICS,
    Message,
    SlowMind,
    StandInRobot,
    agrees,
    in_a_task_of_its_own,
    looks_at,
    stand_in_robot,
)
from tests.teacher.states_of import state_where

FACTS_NOW = facts(level((1.0,), story(1, (1.0,), "back", 0.0)))


@dataclass
class Console:
    """Keyboard and screen of a teacher."""

    client: TeacherClient
    keyboard: int
    clock: Clock
    said: list[str] = field(default_factory=list)

    def type(self, line: str) -> None:
        os.write(self.keyboard, f"{line}\n".encode())

    async def reads(self, text: str) -> str:
        """Wait until the screen shows a text; return its line."""
        await eventually(lambda: any(text in line for line in self.said))
        return next(line for line in self.said if text in line)

    async def asks(self, line: str, answer: str) -> str:
        """Type a line and wait until the screen shows a text; return the line of the text."""
        self.type(line)
        return await self.reads(answer)


TOLD: dict[type[Message], dict[str, object]] = {
    LessonsRequest: {"lessons": []},
    WhyRequest: {"why": FACTS.plain_of(FACTS_NOW)},
    HealthRequest: {"health": HEALTH.plain_of(ILL)},
    SituationsRequest: {"situations": ["the door", "the window"]},
}


async def tells(request: Message) -> Reply:
    """Answer each request."""
    if isinstance(request, HelloRequest):
        return await agrees(request)
    told = TOLD.get(type(request))
    return done(7, text=f"{request.path} is done") if told is None else Reply(ReplyStatus.DONE, told)


@asynccontextmanager
async def console_at(pairing: Pairing, port: int, *, patience_s: float = PATIENCE_S) -> AsyncIterator[Console]:
    reading, writing = os.pipe()
    clock = Clock()
    other_readers = reading_threads()
    with os.fdopen(reading) as lines:
        try:
            async with (
                TeacherClient(pairing.device.folder, port=port, patience_s=patience_s, now=clock) as client,
                anyio.create_task_group() as tasks,
            ):
                console = Console(client, writing, clock)
                tasks.start_soon(TerminalTeacher(client, lines, console.said.append, f"127.0.0.1:{port}").teach)
                yield console
                console.type("quit")
                tasks.cancel_scope.deadline = anyio.current_time() + 2.0
        finally:
            os.close(writing)
            # The thread that reads the pipe sees its end; it must not find the file closed instead.
            for each in reading_threads() - other_readers:
                each.join(PATIENCE_S)


def reading_threads() -> set[threading.Thread]:
    """Return the threads that read a terminal."""
    return {each for each in threading.enumerate() if each.name == "terminal"}


@pytest.fixture
async def robot(pairing: Pairing) -> AsyncIterator[StandInRobot]:
    async with in_a_task_of_its_own(stand_in_robot(pairing.teacher.parent)) as robot:
        robot.mind = tells
        robot.show(teacher="phone")  # so that who takes it sees at once that he teaches
        yield robot


@pytest.fixture
async def console(pairing: Pairing, robot: StandInRobot) -> AsyncIterator[Console]:
    """Return the console of a teacher who has taken the robot."""
    async with in_a_task_of_its_own(console_at(pairing, robot.port)) as console:
        await console.reads("/take is done")
        yield console


async def test_why_explains_what_the_robot_does_now(console: Console) -> None:
    assert "RLA 1" in await console.asks("why", format_decision(FACTS_NOW))


async def test_health_prints_the_report_and_cures(console: Console) -> None:
    await console.asks("health", "sensors silent (urgent), ticks missed; late 2.90 ms (p99), missed 7")
    await console.reads("disk      knowledge: 412 MB free, recordings: no answer")
    await console.reads("!! the range sensors are silent, the newest is 2.5 s old (for 2 s): check that")
    await console.reads("! 3 ticks missed in the last minute")


async def test_enter_stops_at_once_and_ends_pending_commands(console: Console, robot: StandInRobot) -> None:
    robot.mind = SlowMind(Resume, mind=tells)
    console.type("go")
    await robot.hears(Resume)
    console.type("")
    await console.reads("refused: resume was stopped meanwhile")
    await console.reads("/stop is done")
    assert robot.all_of(StopRequest)[0].press_id is None


async def test_motion_typed_before_a_stop_is_not_sent_after_it(console: Console, robot: StandInRobot) -> None:
    robot.mind = mind = SlowMind(LessonsRequest, mind=tells)
    for line in ("lessons", "go", "step forward", "phase 5", "stop"):
        console.type(line)
    await console.reads("/stop is done")
    mind.may_answer.set()
    await console.asks("phase 2", "/phase is done")
    for line in ("go", "step forward", "phase 5"):
        assert any(said.startswith("not done") and said.endswith(f": {line}") for said in console.said)
    assert robot.all_of(Resume) == []
    assert [each.phase for each in robot.all_of(SetPhase)] == [Phase.CORRECTIONS]


async def test_reward_has_the_tick_of_its_typing(console: Console, robot: StandInRobot) -> None:
    robot.mind = mind = SlowMind(LessonsRequest, mind=tells)
    ticks = []
    for line, changes in (
        ("lessons", {}),
        ("+", {}),
        ("-", {}),
        ("forward", {"distance": 812.5, "radius": 600.0}),
        ("spin_left", {"distance": 10.0}),
    ):
        ticks.append((await looks_at(console.client, robot, **changes)).tick)
        console.type(line)
        # A stop does not wait for its turn, so it tells that what stands before it has been read.
        stops = len(robot.all_of(StopRequest))
        console.type("stop")
        await robot.hears(StopRequest, stops + 1)
    await looks_at(console.client, robot, nearest=None)
    mind.may_answer.set()
    (correction,) = await robot.hears(Correct)
    assert [(each.value, each.decision_tick) for each in robot.all_of(Reward)] == [(1, ticks[1]), (-1, ticks[2])]
    assert [(each.action, each.decision_tick) for each in robot.all_of(Teach)] == [("forward", ticks[3])]
    assert (correction.action, correction.decision_tick) == ("spin_left", ticks[4])


async def test_invalid_line_does_not_end_teaching(console: Console, robot: StandInRobot) -> None:
    nines = "9" * 5000
    for line in ("phase", f"step forward {nines}", "step forward 1e9"):
        await console.asks(line, f"not done, {line}: type {line.split()[0]} ")
    for line, says in (
        ("phase 12", "phase has to be one of 1, 2"),
        (f"delete {nines}", "rla_id has to be a whole number"),
        ("replace ² forward", "rla_id has to be a whole number"),
    ):
        console.said.clear()
        await console.asks(line, f"refused: {says}")
    await console.asks("step forward 999999999", "refused: ticks has to be a whole number")
    robot.mind = SlowMind(LessonsRequest, mind=tells)
    wait_for_answers(console.client, 0.3)
    await console.asks("lessons", "no answer for 0.3 s")
    wait_for_answers(console.client)
    await console.asks("phase 2", "/phase is done")


async def test_a_robot_that_is_not_there_ends_teaching(pairing: Pairing) -> None:
    with pytest.raises(BaseExceptionGroup) as ended:
        async with console_at(pairing, 9, patience_s=0.2):
            await anyio.sleep(PATIENCE_S)
    error = ended.value
    while isinstance(error, BaseExceptionGroup):
        (error,) = error.exceptions
    assert isinstance(error, NoAnswerError)
    assert (error.code, error.exit_code) == (NoAnswer.NO_ROBOT, ExitCode.REFUSED)
    assert str(error).startswith("no robot")
    assert "127.0.0.1:9" in str(error)


@pytest.mark.parametrize("teacher", [None, "anna"])
async def test_restarted_robot_is_taken_unless_it_has_a_teacher(pairing: Pairing, teacher: str | None) -> None:
    teachers = pairing.teacher.parent
    async with AsyncExitStack() as first_start, AsyncExitStack() as stack:
        robot = await first_start.enter_async_context(in_a_task_of_its_own(stand_in_robot(teachers)))
        robot.mind = tells
        robot.show(teacher="phone")
        console = await stack.enter_async_context(in_a_task_of_its_own(console_at(pairing, robot.port)))
        await console.reads("/take is done")
        await state_where(console.client)
        await first_start.aclose()
        console.clock.ahead_s += 2.0
        await console.reads("the robot is silent")
        async with stand_in_robot(teachers, port=robot.port, boot=b"new!", showing=False) as robot:
            robot.mind = tells
            robot.show(teacher=teacher)
            robot.showing = True
            await console.reads("the robot program was restarted")
            await console.reads("the robot is back")
            if teacher is None:
                await robot.hears(Take)
            else:
                await console.reads("anna teaches now; type take to teach yourself")
                assert robot.all_of(Take) == []
            await stack.aclose()


@pytest.mark.parametrize(
    ("typed", "says"),
    [
        ("forwrd", "not done, forwrd: no such command or action; did you mean forward?"),
        ("rewnd 2 forward", "not done, rewnd: no such command or action; did you mean rewind"),
        ("xyzzy", "not done, xyzzy: no such command or action; help shows what can be typed"),
        ("hold forwad 2", "not done, hold forwad 2: type hold ACTION SECONDS; did you mean forward?"),
        ("hold forward", "not done, hold forward: type hold ACTION SECONDS"),
    ],
)
def test_wrong_word_is_named_with_what_may_be_meant(typed: str, says: str) -> None:
    assert format_misunderstood(typed.split(), A_HELLO).startswith(says)


async def test_appraisal_by_name_teaches_the_critic(console: Console, robot: StandInRobot) -> None:
    await console.reads("appraisals: bad, neutral, good")
    picture = await looks_at(console.client, robot, phase=4)
    console.type("bad")
    (taught,) = await robot.hears(Appraise)
    assert (taught.appraisal, taught.decision_tick) == ("bad", picture.tick)
    await console.asks("help", "an appraisal ")


async def test_critic_prints_trust_and_opinion(console: Console, robot: StandInRobot) -> None:
    trusted = {"agreement": 0.87, "trusted": True, "signals_missing": (0, 0), "opinion": 1, "opinion_of": 40}
    not_needed = {"role": "not needed", "bad_share": 0.019}
    robot.showing = False
    for shown, says in (
        ({"phase": 4, "signals_missing": (6, 2)}, "needs 6 bad and 2 good signals from you (not trusted)"),
        (trusted, "agrees with you 0.87 (trusted)"),
        ({"phase": 5, "role": "measures"}, "agrees with you 0.87 (trusted; measures the driving)"),
        (not_needed, "agrees with you 0.87 (trusted; not needed: 1 % of the driving was bad)"),
        ({"role": "acts"}, "agrees with you 0.87 (trusted; acts)"),
    ):
        robot.show(**shown)
        await console.reads(f"critic: {says}")
    await console.asks("critic", "critic: thinks good · agrees with you 0.87 (trusted; acts)")
    await console.reads("critic: changed nothing lately")


def test_format_opinion_and_change_are_one_line_each() -> None:
    assert " 0.79 " in format_opinion(state(agreement=0.799), CRITICS)
    changed = LessonLine("c", "RLA 7: stand", "critic", 5, 9, "", False)
    assert format_critic_change(changed).endswith(changed.text)
    assert format_critic_change(changed._replace(undone=True)).endswith("stand, undone")


async def test_behaviour_by_name_teaches_the_mid_level(console: Console, robot: StandInRobot) -> None:
    robot.show(cause="unknown", asks_at="mid", mid=COMMANDS._replace(rla=None, distance=7.0, asks=True))
    await console.reads("teach me which behaviour to follow: nearest is mid-level RLA 12 (turn_left) at 7 of 6")
    await console.asks("turn_left", "/answer is done")
    (answer,) = robot.all_of(Teach)
    assert (answer.action, answer.level, answer.alternative) == ("turn_left", "mid", False)
    robot.show(cause="rla", action="forward", rla=3, asks_at="basic", mid=COMMANDS)
    await console.reads("turn_left because mid-level RLA 12: 2 of 12 differ, R 6")
    await console.asks("straight_on", "/correct is done")
    assert [(each.action, each.level) for each in robot.all_of(Correct)] == [("straight_on", "mid")]
    console.type("also straight_on")
    await robot.hears(Teach, 2)
    assert robot.all_of(Teach)[-1].alternative
    await console.asks("pursue straight_on", "/pursue is done")
    robot.show(mid=COMMANDS._replace(behaviour="straight_on", rla=None, overridden=True))
    await console.reads("straight_on, because a teacher said so, until it has finished")
    assert "left, straight, right, " in await console.asks("way", "RLA 12 knows left, straight, left")
    robot.show(surprise=SURPRISED._replace(tick=robot.state.tick, new=True))
    assert "never followed" in await console.reads("surprise: 3.5 times as far off as usual")


async def test_places_are_named_and_sought(console: Console, robot: StandInRobot) -> None:
    for line, path in (
        ("name the door", "/name"),
        ("seek the door", "/seek"),
        ("seek rla 12", "/seek"),
        ("seek x_m=1.8 y_m=-3 within 0.25", "/seek"),
        ("here the door", "/here"),
    ):
        await console.asks(line, f"{path} is done")
    assert [each.name for each in robot.all_of(NameSituation)] == ["the door"]
    name, rla, like = (each.goal for each in robot.all_of(Seek))
    assert (name, rla) == (NamedGoal("the door"), RlaGoal(12))
    assert like == PartialGoal((("x_m", 1.8), ("y_m", -3.0)), 0.25)
    assert [each.name for each in robot.all_of(BeAt)] == ["the door"]
    console.type("seek")
    await robot.hears(StopSeeking)
    await console.asks("places", "named: the door, the window")
    robot.show(cause="no way", action=None, rla=None, goal="door", plan_says="no way from here to door")
    await console.reads("Stands: no way from here to door")
    console.type("seek x_m=high")  # no number: the name of a place, then
    assert (await robot.hears(Seek, 4))[-1].goal == NamedGoal("x_m=high")
    await console.asks("help", "seek FEATURE=VALUE")


async def test_hold_sends_the_action_for_its_time(console: Console, robot: StandInRobot) -> None:
    console.type("hold spin_left 0.2")
    stop = (await robot.hears(StopRequest))[-1]
    holds = robot.all_of(HoldAction)
    assert {(each.action, each.press_id) for each in holds} == {("spin_left", stop.press_id)}
    assert len(holds) > 1
