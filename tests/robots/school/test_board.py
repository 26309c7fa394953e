"""Boards that boot after an opening, restart, end lines with CR LF, or send what cannot be read."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hal.bus import BusError
from hal.robot_link import NoticeReport, RangeReport, Report, WheelReport
from kurt2rt.robots.school.lines import COUNTERS, encode
from tests.robots.school.board import Board
from tests.robots.school.rig import FORWARD

STALE_S = 0.1


def greet(board: Board) -> None:
    board.link.greet(lambda: board.now_s, lambda _: board.step())


def drive(board: Board, seconds: float) -> list[tuple[float, Report]]:
    """Drive on, and return each report and the time at which it came."""
    reports: list[tuple[float, Report]] = []
    for _ in range(round(seconds * 100)):
        board.step()
        reports += [(board.now_s, each) for each in board.link.receive(board.now_s)]
        board.link.send(FORWARD)
    return reports


def notices(reports: list[tuple[float, Report]]) -> list[str]:
    return [each.text for _, each in reports if isinstance(each, NoticeReport)]


@given(
    uptime_ms=st.one_of(
        st.integers(100, 4000), st.integers(4000, 10**8), st.integers(-4000, 4000).map(lambda ms: COUNTERS + ms)
    ),
    boots_for_ms=st.integers(0, 300).map(lambda tens: tens * 10),
    lost=st.integers(0, 50),
)
def test_board_that_restarts_is_read_within_a_second(uptime_ms: int, boots_for_ms: int, lost: int) -> None:
    board = Board(uptime_ms=uptime_ms)
    greet(board)
    board.ticks_ms = 2  # at its highest speed
    drive(board, 0.3)
    board.ticks_ms = 0
    board.reset(boots_for_ms, loses_lines=lost)
    reports = drive(board, boots_for_ms / 1000 + lost / 50 + 2.0)
    ages_s = [(now_s, now_s - each.at_s) for now_s, each in reports if isinstance(each, RangeReport)]
    settled_s = [age_s for now_s, age_s in ages_s if now_s >= board.first_line_ms / 1000 + 1.0]
    assert len(settled_s) >= 49
    assert max(settled_s) < STALE_S
    assert sum(abs(each.left_ticks) for _, each in reports if isinstance(each, WheelReport)) <= 2 * 20


@pytest.mark.parametrize(
    ("garbage", "told"),
    [
        (b"\xff\x80\x81\n", r"no school robot answers: \d+ lines came, none valid; check bit rate"),
        (b"", r"no school robot answers; switch the robot on"),
        (encode("sense", 1, 20, 0, 0, -1, *(9,) * 7), r"\d+ lines of a school robot came, and no greeting; check"),
    ],
)
def test_greet_without_an_answer_says_what_came(garbage: bytes, told: str) -> None:
    board = Board(boots_for_ms=0 if garbage else 100_000)
    board.garbage = garbage
    with pytest.raises(BusError, match=told):
        greet(board)
    assert board.now_s < 11.0


def test_board_that_talks_another_way_after_a_restart_is_named() -> None:
    board = Board()
    greet(board)
    assert notices(drive(board, 1.0)) == []
    board.garbage = b"\xff\x80\x81\n"
    told = notices(drive(board, 2.0))
    assert all("lines came, none valid; check bit rate" in each for each in told)
    assert 1 <= len(told) <= 3
    board.garbage = b""
    assert notices(drive(board, 1.0)) == [""]


def test_board_that_never_answers_after_a_loss_is_named() -> None:
    board = Board()
    greet(board)
    board.link.reopen()
    board.garbage = encode("sense", 1, 20, 0, 0, -1, *(9,) * 7)
    told = notices(drive(board, 2.0))
    assert told
    assert "came, and no greeting; check bit rate, firmware and both wires" in told[-1]
