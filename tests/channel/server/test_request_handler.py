"""The rules by which the robot takes what its teachers send, on ticks that the test makes."""

import hashlib
from typing import Any, get_args

import pytest

from kurt2rt.channel.protocol.codec import PATHS, decode_answer, encode_answer
from kurt2rt.channel.protocol.lesson_list import LESSONS, Contradicting
from kurt2rt.channel.protocol.requests import (
    BackToStartRequest,
    CommandRequest,
    ExamRequest,
    ExamStatusRequest,
    ExportRequest,
    LessonsRequest,
    LoadRequest,
    MoveWallRequest,
    NextRunRequest,
    PlaceRequest,
    SaveRequest,
    SimulationRequest,
    SpeedRequest,
    StopRequest,
    TickRequest,
    UploadRequest,
    WhyRequest,
    WorldRequest,
)
from kurt2rt.channel.protocol.simulation import EXAM, SIMULATION, ExamStatus
from kurt2rt.channel.server.dependencies import TeacherNow
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done
from kurt2rt.channel.server.request_handler import COMMAND_TICKS, MOVING_TICKS, STREAM_TICKS
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.decision.standing import ActiveStop, StopReason
from kurt2rt.core.message_fields import checks_of
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import (
    BeginSession,
    Pursue,
    Resume,
    RunBehaviour,
    Seek,
    SetPhase,
    Single,
    StopSeeking,
    Take,
    Teach,
    Undo,
)
from kurt2rt.platform.simulated_clock import SimulatedClock
from tests.channel.channel_fixture import BOOT, ChannelFixture, outcome_of, reply_of, turns, why
from tests.channel.grounds import Yard
from tests.channel.hostile_datagrams import HostileDatagrams

MOVING = {*(RunBehaviour, Pursue, Resume, Take, Seek, StopSeeking, SetPhase), *(PlaceRequest, BackToStartRequest)}
COMMANDS = {kind for kind in PATHS.values() if issubclass(kind, (*get_args(Single), CommandRequest))}
LAST_START = b"last"


def any_command(desk: ChannelFixture, kind: type[Single | CommandRequest], **head: Any) -> CommandRequest:
    """Return a valid command of a kind."""
    valid = HostileDatagrams(1, lambda: (BOOT, desk.tick)).valid(kind.path)
    fields = valid.command if isinstance(valid, TickRequest) else valid
    own = [name for name in checks_of(kind) if name not in checks_of(CommandRequest)]
    return desk.command(kind, *(getattr(fields, name) for name in own), **head)


@pytest.fixture
def yard() -> Yard:
    return Yard()


@pytest.fixture
def sim(yard: Yard) -> ChannelFixture:
    """Return a desk whose robot is simulated."""
    return ChannelFixture(ground=yard)


def verdict(reply: Reply) -> tuple[object, Outcome | None]:
    """Return the wire word of a refusal, and the outcome."""
    return why(reply), outcome_of(reply)


# Streams.


async def test_hold_drives_and_its_release_tells_the_lessons(desk: ChannelFixture) -> None:
    desk.run()
    assert await desk.stream(desk.hold()) == Reply(ReplyStatus.DONE, {"t": desk.tick})
    record = desk.run()
    assert (record.decision.cause, record.decision.action) == (DecisionCause.TEACHER, "forward")
    released = await desk.ask(StopRequest(desk.new_id(), 1))
    assert outcome_of(released) == Outcome.of(ResultCode.HOLD_RELEASED, lessons=1, lesson="ann-hold-1")
    assert desk.record.decision.cause is not DecisionCause.STOPPED


@pytest.mark.parametrize("kind", ["watch", "press"])
@pytest.mark.parametrize(("age", "answer"), [(0, ""), (STREAM_TICKS, ""), (STREAM_TICKS + 1, "stale"), (-1, "stale")])
async def test_a_stream_is_good_for_forty_ticks_and_not_for_the_future(
    desk: ChannelFixture, kind: str, age: int, answer: str
) -> None:
    assert why(await desk.stream(desk.watch(age=age) if kind == "watch" else desk.press(age=age))) == answer


async def test_a_message_for_another_start_of_the_program_is_refused(desk: ChannelFixture) -> None:
    for request in (desk.watch(boot=LAST_START), desk.press(boot=LAST_START)):
        assert why(await desk.stream(request)) == "boot"
    assert desk.run().decision.cause is DecisionCause.UNKNOWN


async def test_only_the_newest_message_of_a_device_counts(desk: ChannelFixture) -> None:
    assert why(await desk.stream(desk.press(), number=7)) == ""
    assert why(await desk.stream(desk.press(), number=7)) == "old"
    assert why(await desk.stream(desk.watch(), number=6)) == "old"
    assert why(await desk.stream(desk.press(), number=8)) == ""


async def test_stop_late_copy_does_not_count_as_newest(desk: ChannelFixture) -> None:
    await desk.stream(desk.watch(), number=20)
    stop = await desk.send(desk.stop(), number=12)
    desk.run()
    await reply_of(stop)
    assert why(await desk.stream(desk.watch(), number=20)) == "old"
    assert why(await desk.stream(desk.watch(), number=21)) == ""


async def test_stream_sent_before_stop_does_not_drive_after_it(desk: ChannelFixture) -> None:
    """The first message of a press may be overtaken by the stop that ended it."""
    stop = await desk.send(desk.stop(), number=12)
    assert why(await desk.stream(desk.press(hold=1), number=11)) == "old"
    assert desk.run().decision.cause is DecisionCause.STOPPED
    await reply_of(stop)
    assert why(await desk.stream(desk.press(hold=2), number=13)) == ""


async def test_press_ended_by_stop_is_refused_and_next_one_drives(desk: ChannelFixture) -> None:
    await desk.stream(desk.press(hold=1))
    desk.run()
    await desk.ask(desk.stop())
    assert why(await desk.stream(desk.press(hold=1))) == "stopped"
    assert why(await desk.stream(desk.watch())) == ""
    assert why(await desk.stream(desk.press(hold=2))) == ""


async def test_after_another_ones_stop_the_driver_has_to_say_resume(desk: ChannelFixture) -> None:
    await desk.stream(desk.press(hold=1))
    desk.run()
    await desk.ask(desk.stop(), "ben")
    refused = await desk.stream(desk.press(hold=2))
    assert verdict(refused) == ("stopped", Outcome.of(RefusalCode.STOPPED_BY, teachers=("ben",)))
    await desk.ask(desk.command(Resume))
    assert why(await desk.stream(desk.press(hold=2))) == ""


async def test_stream_of_another_device_is_held_with_teacher_name(desk: ChannelFixture) -> None:
    await desk.stream(desk.press(), "ann")
    desk.run()
    for request in (desk.press(), desk.watch()):
        refused = await desk.stream(request, "ben")
        assert refused.status is ReplyStatus.CONFLICT
        assert verdict(refused) == ("held", Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher="ann"))


async def test_inbox_full_refuses_new_commands_and_keeps_old(desk: ChannelFixture) -> None:
    waiting = 0
    while why(await desk.stream(desk.watch())) == "":
        waiting += 1
    for refused in (await desk.stream(desk.press()), await reply_of(await desk.send(desk.answer()))):
        assert verdict(refused) == ("refused", Outcome(RefusalCode.TOO_MANY))
    assert len(desk.runtime.inbox.pop_all()) == waiting
    assert why(await desk.stream(desk.watch())) == ""


# Commands.


@pytest.mark.parametrize("kind", sorted(COMMANDS, key=str))
async def test_a_command_for_another_start_of_the_program_is_refused(
    desk: ChannelFixture, kind: type[CommandRequest]
) -> None:
    refused = await desk.ask(any_command(desk, kind, boot=LAST_START))
    assert (why(refused), refused.body["t"]) == ("boot", desk.tick)
    assert desk.record.results == ()


@pytest.mark.parametrize("kind", sorted(COMMANDS, key=str))
async def test_command_state_age_limit_depends_on_kind(sim: ChannelFixture, kind: type[CommandRequest]) -> None:
    longest = MOVING_TICKS if kind in MOVING else COMMAND_TICKS
    for age in (longest + 1, -1):
        assert why(await sim.ask(any_command(sim, kind, age=age))) == "stale"
        assert sim.record.results == ()
    assert why(await sim.ask(any_command(sim, kind, age=longest))) in ("", "refused", "held")


@pytest.mark.parametrize("kind", sorted(COMMANDS - {Take}, key=str))
async def test_a_command_of_one_who_is_not_the_teacher_is_refused(
    sim: ChannelFixture, kind: type[CommandRequest]
) -> None:
    await sim.ask(sim.command(Take), "ann")
    refused = await sim.ask(any_command(sim, kind), "ben")
    assert verdict(refused) == ("held", Outcome.of(RefusalCode.ANOTHER_TEACHES, teacher="ann"))
    assert sim.shelf.labels == []


async def test_a_lesson_is_answered_only_when_it_is_durable(desk: ChannelFixture) -> None:
    task = await desk.send(desk.answer())
    desk.run(50)
    await turns()
    assert desk.runtime.level.system.rlas  # it acts already
    assert not task.done()
    desk.write()
    reply = await reply_of(task)
    lesson = desk.notebook.events[0].origin.command_id
    taught = Outcome.of(ResultCode.RLA_TAUGHT, rla=1, action="forward")
    assert reply == done(desk.tick, taught, lesson=lesson, row=1)


async def test_command_repeated_while_pending_counts_once(desk: ChannelFixture) -> None:
    request = desk.answer()
    first = await desk.send(request)
    again = await desk.send(request)
    desk.run()
    late = await desk.send(request)
    desk.run()
    assert not any(task.done() for task in (first, again, late))
    desk.write()
    replies = [await reply_of(task) for task in (first, again, late)]
    assert replies[0].status is ReplyStatus.DONE
    assert replies[1:] == [replies[0]] * 2
    assert await reply_of(await desk.send(request)) == replies[0]
    assert len(desk.notebook.events) == 1


async def test_command_of_earlier_start_is_answered_as_repeated(desk: ChannelFixture) -> None:
    request = desk.command(Teach, "forward", None, boot=LAST_START)
    desk.runtime.handler.updater.handled_ids.add(f"ann-{request.command_id.hex()}")
    reply = await desk.ask(request)
    assert (reply.status, outcome_of(reply)) == (ReplyStatus.DONE, Outcome(ResultCode.REPEATED))
    assert "lesson" not in reply.body


async def test_a_lesson_that_can_never_be_written_is_told_as_unsaved(desk: ChannelFixture) -> None:
    task = await desk.send(desk.answer())
    desk.run()
    desk.write(error="the disk is full")
    reply = await reply_of(task)
    assert (reply.status, why(reply), reply.body["text"]) == (ReplyStatus.UNSAVED, "unsaved", "the disk is full")


async def test_lesson_not_durable_in_time_is_unsaved_and_counts_later() -> None:
    desk = ChannelFixture(longest_wait_s=0.0)
    request = desk.answer()
    reply = await desk.ask(request, write=False)
    assert (reply.status, why(reply)) == (ReplyStatus.UNSAVED, "unsaved")
    assert outcome_of(reply) == Outcome(RefusalCode.NOT_SAVED_YET)
    desk.run()
    desk.write()
    assert outcome_of(await reply_of(await desk.send(request))) == Outcome.of(
        ResultCode.RLA_TAUGHT, rla=1, action="forward"
    )


async def test_one_who_hangs_up_does_not_cost_the_next_copy_its_reply(desk: ChannelFixture) -> None:
    for request in (desk.answer(), desk.stop()):
        first = await desk.send(request)
        again = await desk.send(request)
        first.cancel()
        await turns()
        desk.run()
        desk.write()
        assert (await reply_of(again)).status is ReplyStatus.DONE


async def test_take_is_refused_only_while_another_drives_by_hand(desk: ChannelFixture) -> None:
    await desk.stream(desk.press(), "ann")
    desk.run()
    refused = await desk.ask(desk.command(Take), "ben")
    assert verdict(refused) == ("refused", Outcome.of(RefusalCode.DRIVES_BY_HAND, teacher="ann"))
    await desk.ask(desk.stop(), "ben")
    assert outcome_of(await desk.ask(desk.command(Take), "ben")) == Outcome.of(ResultCode.TAKEN, teacher="ben")


# Stop.


async def test_stop_needs_no_start_no_state_and_no_charge(desk: ChannelFixture) -> None:
    await desk.ask(desk.command(Take), "ann")
    reply = await desk.ask(desk.stop(), "ben")
    assert outcome_of(reply) == Outcome(ResultCode.STOPPED)
    assert desk.run().decision.cause is DecisionCause.STOPPED


async def test_each_copy_of_a_stop_stops_again(desk: ChannelFixture) -> None:
    stop = desk.stop()
    first = await desk.ask(stop, "ben")
    await desk.ask(desk.command(Resume), "ann")
    assert desk.record.decision.cause is DecisionCause.UNKNOWN
    assert await desk.ask(stop, "ben") == first
    assert desk.run().decision.cause is DecisionCause.STOPPED


# Copies of the knowledge.


def not_durable(code: RefusalCode, line: str) -> Outcome:
    """Return the outcome of work that a disk, whose line is shown, kept from being durable."""
    return Outcome.of(code, cause="not durable", where="", says=line)


@pytest.mark.parametrize("kind", [SaveRequest, ExportRequest])
async def test_save_on_failing_disk_is_unsaved_with_reason(desk: ChannelFixture, kind: type[CommandRequest]) -> None:
    desk.shelf.problem = "saved: nothing can be saved there; give a folder that has room"
    reply = await desk.ask(any_command(desk, kind))
    assert (reply.status, reply.body["text"]) == (ReplyStatus.UNSAVED, desk.shelf.problem)
    assert outcome_of(reply) == not_durable(RefusalCode.COPY_FAILED, desk.shelf.problem)


async def test_save_slow_copy_goes_on_and_answers_repetition() -> None:
    desk = ChannelFixture(longest_wait_s=0.0)
    desk.shelf.may_finish.clear()
    request = desk.command(SaveRequest, "")
    assert why(await desk.ask(request)) == "unsaved"
    desk.shelf.may_finish.set()
    await turns()
    assert (await reply_of(await desk.send(request))).body["name"] == "lessons.knowledge"
    assert desk.shelf.labels == [""]


# Exams.


async def test_an_exam_is_begun_by_the_teacher_alone_and_once(sim: ChannelFixture) -> None:
    assert why(await sim.ask(sim.command(ExamRequest))) == "held"
    await sim.ask(sim.command(Take), "bob")
    assert why(await sim.ask(sim.command(ExamRequest))) == "held"
    request = sim.command(ExamRequest)
    first = await sim.ask(request, "bob")
    assert (first.status, await sim.ask(request, "bob")) == (ReplyStatus.DONE, first)
    assert sim.shelf.examined == 1
    sim.shelf.problem = "the disk is full"
    failed = await sim.ask(sim.command(ExamRequest), "bob")
    assert outcome_of(failed) == not_durable(RefusalCode.EXAM_FAILED, "the disk is full")
    sim.exam = ExamStatus(True, 0.25, "exam without teacher, world a")
    assert why(await sim.ask(sim.command(ExamRequest), "bob")) == "refused"
    told = (await sim.ask(ExamStatusRequest())).body["exam"]
    assert EXAM.read(decode_answer(encode_answer(told))) == sim.exam


# The simulation.


async def test_the_next_run_is_its_teachers_to_begin_and_ends_this_one(
    sim: ChannelFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("kurt2rt.channel.server.off_tick_requests.LAST_ANSWER_S", 0.0)
    ended: list[bool] = []
    monkeypatch.setattr(sim.runtime.scheduler, "end", lambda: ended.append(True))
    assert why(await sim.ask(sim.command(NextRunRequest, "b", None, False))) == "held"
    await sim.ask(sim.command(Take))
    await sim.ask(sim.command(BeginSession, "noon"))
    unknown = await sim.ask(sim.command(NextRunRequest, "nowhere", None, False))
    assert outcome_of(unknown) == Outcome.of(RefusalCode.NO_WORLD, world="nowhere", known=("a", "b"))
    broken = await sim.ask(sim.command(NextRunRequest, "broken", None, False))
    assert outcome_of(broken) == Outcome.of(RefusalCode.NEXT_RUN_CRASHED, error="RuntimeError('no such thing')")
    assert not ended
    request = sim.command(NextRunRequest, "b", "eight", True)
    reply = await sim.ask(request)
    assert (reply.status, await sim.ask(request)) == (ReplyStatus.DONE, reply)
    assert outcome_of(reply) == Outcome.of(ResultCode.NEXT_RUN, world="b", task="eight")
    assert sim.simulation.prepared == [("b", "eight", True, TeacherNow("ann", 1, "noon"))]
    assert ended == [True]
    assert why(await sim.ask(sim.command(NextRunRequest, "c", None, False))) == "refused"
    told = (await sim.ask(SimulationRequest())).body["simulation"]
    assert SIMULATION.read(decode_answer(encode_answer(told))) == await sim.simulation.view()


async def test_no_next_run_begins_while_lessons_cannot_be_saved(
    sim: ChannelFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(sim.runtime.scheduler, "end", lambda: pytest.fail("lessons that wait end with their run"))
    await sim.ask(sim.command(Take))
    sim.shelf.problem = "var/a.knowledge: the disk is full"
    reply = await sim.ask(sim.command(NextRunRequest, "b", None, False))
    assert (why(reply), reply.body["text"]) == ("refused", sim.shelf.problem)
    assert outcome_of(reply) == not_durable(RefusalCode.NEXT_RUN_FAILED, sim.shelf.problem)
    assert not sim.simulation.prepared


async def test_speed_scales_leases_in_robot_time(sim: ChannelFixture) -> None:
    assert why(await sim.ask(sim.command(SpeedRequest, 4))) == "held"
    await sim.ask(sim.command(Take))
    assert why(await sim.stream(sim.watch(age=STREAM_TICKS + 1))) == "stale"
    assert (await sim.ask(sim.command(SpeedRequest, 4))).status is ReplyStatus.DONE
    sim.run()
    assert sim.speed.wanted == 4
    assert why(await sim.stream(sim.watch(age=4 * STREAM_TICKS))) == ""
    assert why(await sim.stream(sim.watch(age=4 * STREAM_TICKS + 1))) == "stale"
    await sim.stream(sim.watch())
    sim.run(4 * 24)
    assert sim.runtime.handler.authority.is_present(sim.tick)
    sim.run(1)
    assert not sim.runtime.handler.authority.is_present(sim.tick)
    told = SIMULATION.read((await sim.ask(SimulationRequest())).body["simulation"])
    assert (told.speed, told.reached) == (4, 1.0)


@pytest.mark.parametrize(
    ("reached", "stop", "times"),
    [(2.5, ActiveStop(StopReason.FALLS_BEHIND, "4"), 1), (4.0, ActiveStop(StopReason.LINK_LOST, "ann"), 4)],
)
async def test_computer_too_slow_for_the_speed_is_no_lost_link(
    sim: ChannelFixture, monkeypatch: pytest.MonkeyPatch, reached: float, stop: ActiveStop, times: int
) -> None:
    monkeypatch.setattr(SimulatedClock, "reached", reached)
    await sim.ask(sim.command(Take))
    assert (await sim.ask(sim.command(SpeedRequest, 4))).status is ReplyStatus.DONE
    sim.runtime.inbox.put(Teach("t", "ann", "forward"))
    await sim.stream(sim.watch())
    sim.run(4 * 24)
    assert sim.record.decision.driving
    sim.run(2)
    assert sim.record.standing.stop == stop
    assert (sim.speed.wanted, sim.runtime.handler.authority.speed) == (times, times)


async def test_put_back_is_refused_after_stop_like_place(sim: ChannelFixture, yard: Yard) -> None:
    await sim.ask(sim.command(Take))
    assert (await sim.ask(sim.command(BackToStartRequest))).status is ReplyStatus.DONE
    request = sim.command(BackToStartRequest)
    await sim.ask(sim.stop())
    assert why(await sim.ask(request)) == "refused"
    assert yard.changes == [("start",)]


async def test_upload_in_parts_is_loaded_once(sim: ChannelFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("kurt2rt.channel.server.off_tick_requests.LAST_ANSWER_S", 0.0)
    content, upload = b"PK" + bytes(1000), b"12345678"
    monkeypatch.setattr(sim.runtime.scheduler, "end", lambda: None)
    parts = [UploadRequest(BOOT, upload, at, content[at : at + 896]) for at in (0, 896)]
    assert why(await sim.ask(parts[0])) == "held"
    await sim.ask(sim.command(Take))
    assert why(await sim.ask(parts[1])) == "refused"
    assert [(await sim.ask(each)).body["size"] for each in (parts[0], parts[0], parts[1])] == [896, 896, 1002]
    assert why(await sim.ask(UploadRequest(LAST_START, upload, 0, b"PK"))) == "boot"
    fingerprint = hashlib.sha256(content).digest()
    assert why(await sim.ask(sim.command(LoadRequest, upload, bytes(32)))) == "refused"
    assert (await sim.ask(sim.command(LoadRequest, upload, fingerprint))).status is ReplyStatus.DONE
    assert sim.simulation.prepared == [(content, TeacherNow("ann", 1, None))]


async def test_a_real_robot_has_no_next_run(desk: ChannelFixture) -> None:
    await desk.ask(desk.command(Take))
    requests = (
        desk.command(NextRunRequest, None, None, True),
        desk.command(BackToStartRequest),
        desk.command(LoadRequest, bytes(8), bytes(32)),
        desk.command(SpeedRequest, 2),
        UploadRequest(BOOT, bytes(8), 0, b"PK"),
        SimulationRequest(),
    )
    for request in requests:
        assert (await desk.ask(request)).status is ReplyStatus.NOT_HERE


# Looking.


async def test_why_is_limited_to_ten_a_second(desk: ChannelFixture) -> None:
    """An answer takes a millisecond of the loop, so each device has a limit."""
    desk.run(1)
    at_once = [(await desk.ask(WhyRequest(), "bob")).status for _ in range(20)]
    assert at_once.count(ReplyStatus.DONE) == 5
    assert set(at_once[5:]) == {ReplyStatus.CONFLICT}
    assert (await desk.ask(WhyRequest(), "ann")).status is ReplyStatus.DONE
    answered = 0
    for _ in range(100):
        desk.run(1)
        answered += (await desk.ask(WhyRequest(), "bob")).status is ReplyStatus.DONE
    assert answered == 10


async def test_a_simulated_world_is_told_and_changed(sim: ChannelFixture, yard: Yard) -> None:
    world = (await sim.ask(WorldRequest())).body
    assert decode_answer(encode_answer(world)) == {
        "version": 0,
        "name": "yard",
        "size": [4.0, 4.0],
        "outline": [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]],
        "walls": [["box", [[1.0, 1.0], [2.0, 1.0], [2.0, 2.0]]]],
        "round": [["post", 3.0, 3.0, 0.1]],
    }
    move = sim.command(MoveWallRequest, "box", 0.5, -0.25)
    reply = await sim.ask(move)
    assert (reply.status, outcome_of(reply)) == (ReplyStatus.DONE, Outcome.of(ResultCode.WALL_MOVED, name="box"))
    assert await sim.ask(move) == reply  # sent again: it moves once
    assert outcome_of(await sim.ask(sim.command(PlaceRequest, 1.0, 2.0, 0.5))) == Outcome(ResultCode.ROBOT_PLACED)
    assert yard.changes == [("box", 0.5, -0.25), (1.0, 2.0, 0.5)]


async def test_impossible_change_of_the_world_is_refused_with_code(sim: ChannelFixture, yard: Yard) -> None:
    yard.start_blocked = True
    no_wall = Outcome.of(RefusalCode.NO_WALL, world="yard", name="tree", known=("box", "post"))
    for request, outcome in (
        (sim.command(MoveWallRequest, "tree", 0.5, 0.0), no_wall),
        (sim.command(MoveWallRequest, "post", 0.5, 0.0), Outcome.of(RefusalCode.WALL_ON_ROBOT, name="post")),
        (sim.command(PlaceRequest, 50.0, 0.0, 0.0), Outcome(RefusalCode.NO_ROOM)),
        (sim.command(BackToStartRequest), Outcome(RefusalCode.START_BLOCKED)),
    ):
        assert verdict(await sim.ask(request)) == ("refused", outcome)


async def test_lesson_that_contradicts_its_neighbours_is_named(desk: ChannelFixture) -> None:
    for counts in (100, 110, 120, 140, 150):
        desk.run(counts=counts)
        await desk.ask(desk.answer("forward"))
    assert not any(each[-1] for each in (await desk.ask(LessonsRequest(20))).body["lessons"])
    desk.run(counts=131)
    slip = desk.answer("back")
    taught = outcome_of(await desk.ask(slip))
    assert taught is not None
    assert (taught.fields["against"], taught.fields["nearest"]) == (("forward",), 4)
    listed = decode_answer(encode_answer((await desk.ask(LessonsRequest(20))).body))
    lesson, *others = LESSONS.read(listed["lessons"])
    assert lesson.against == (Contradicting(lesson.command_id, 6, "back", 4, ("forward",)),)
    assert not any(each.against for each in others)
    await desk.ask(desk.command(Undo, lesson.command_id))
    assert not any(each[-1] for each in (await desk.ask(LessonsRequest(20))).body["lessons"])
