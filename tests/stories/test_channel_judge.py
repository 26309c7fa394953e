"""The judge of the channel: what it lets pass, and that it would see a channel that takes what it must not."""

import pytest

from kurt2rt.channel.protocol.requests import Request, StreamRequest, tick_request
from kurt2rt.channel.server.reply import Reply, ReplyStatus, done, refusal
from kurt2rt.channel.server.request_handler import Sender
from kurt2rt.core.outcome import Outcome, RefusalCode, ResultCode
from kurt2rt.core.teaching.commands import Drive, Resume, Teach, Watch
from tests.stories.channel_judge import ChannelJudge

BOOT, OLD_BOOT = b"2" * 8, b"1" * 8
TICK = 500
TAKEN = Reply(ReplyStatus.DONE, {"t": TICK})


def watch(seen: int, boot: bytes = BOOT) -> Request:
    return StreamRequest(boot, Watch("", seen))


def command(kind: type[Resume | Teach], seen: int, boot: bytes = BOOT) -> Request:
    own = {"action": "left"} if kind is Teach else {}
    return tick_request(kind, boot, b"12345678", seen, **own)


def judged(*taken: tuple[int, Request, Reply], ticks: int = 0, by_hand: bool = False) -> list[str]:
    """Return the complaints about these messages of one device, with their numbers, some ticks after each other."""
    judge = ChannelJudge()
    judge.begin_program(BOOT)
    for number, request, reply in taken:
        judge.on_reply(Sender("eve", b"", number), request, TICK, reply)
        for tick in range(TICK, TICK + ticks):
            judge.on_tick(tick, by_hand=by_hand)
    return judge.problems


@pytest.mark.parametrize(
    "taken",
    [
        [(1, watch(TICK - 40), TAKEN), (2, watch(TICK), TAKEN)],
        [(2, watch(TICK), TAKEN), (1, watch(TICK), refusal("old", Outcome(RefusalCode.OVERTAKEN), TICK))],
        [(1, command(Resume, TICK - 100), done(TICK))],
        [(1, command(Teach, TICK - 300), done(TICK))],
        [(1, command(Teach, 0, OLD_BOOT), done(TICK, Outcome(ResultCode.REPEATED)))],
        [(1, command(Teach, TICK), done(TICK)), (2, command(Teach, TICK - 400), done(TICK))],
    ],
)
def test_it_lets_pass_what_may_be_taken(taken: list[tuple[int, Request, Reply]]) -> None:
    assert judged(*taken) == []


@pytest.mark.parametrize(
    ("taken", "complaint"),
    [
        ([(2, watch(TICK), TAKEN), (1, watch(TICK), TAKEN)], "/watch in tick 500: taken again, or after a newer one"),
        ([(1, watch(TICK), TAKEN)] * 2, "taken again, or after a newer one"),
        ([(1, watch(TICK - 41), TAKEN)], "taken though its teacher saw tick 459"),
        ([(1, command(Resume, TICK - 101), done(TICK))], "taken though its teacher saw tick 399"),
        ([(1, command(Teach, TICK - 301), done(TICK))], "taken though its teacher saw tick 199"),
        ([(1, watch(TICK, OLD_BOOT), TAKEN)], "meant for another start of the program"),
        ([(1, command(Teach, TICK, OLD_BOOT), done(TICK))], "meant for another start of the program"),
    ],
)
def test_it_complains_of_what_must_not_be_taken(taken: list[tuple[int, Request, Reply]], complaint: str) -> None:
    (said,) = judged(*taken)
    assert complaint in said


@pytest.mark.parametrize(("ticks", "by_hand", "is_over"), [(30, True, False), (31, True, True), (31, False, False)])
def test_a_press_that_drove_is_over_after_a_silence(ticks: int, by_hand: bool, is_over: bool) -> None:
    drive = StreamRequest(BOOT, Drive("", TICK, 7, 0.1, 0.1))
    said = " ".join(judged((1, drive, TAKEN), (2, drive, TAKEN), ticks=ticks, by_hand=by_hand))
    assert [each in said for each in ("driven by a hand that is silent", "its press is over")] == [is_over] * 2


def test_it_counts_ticks_since_the_newest_picture_that_was_taken() -> None:
    judge = ChannelJudge()
    judge.begin_program(BOOT)
    for tick in (1, 2, 30):
        judge.on_tick(tick, by_hand=False)
    judge.on_reply(Sender("eve", b"", 1), watch(2), 30, TAKEN)
    assert judge.picture_ticks == 1
