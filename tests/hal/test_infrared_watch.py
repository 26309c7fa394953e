"""A board that repeats itself is found out; one that lives, or a robot that stands, is left alone."""

import pytest

from hal.infrared_frames import board_of
from hal.infrared_watch import InfraredWatch

CHANNELS = ("ADC07", "BDC00", "ADC03", "BDC15", "ADC14")
FROZEN_S = 1.5


@pytest.fixture
def watch() -> InfraredWatch:
    watch = InfraredWatch(map(board_of, CHANNELS), FROZEN_S)
    assert watch.check_frozen(10.0, driving=False) == ""
    return watch


def test_channels_of_one_controller_share_their_board(watch: InfraredWatch) -> None:
    assert watch.board(board_of("ADC07")) is watch.board(board_of("ADC14"))
    assert watch.board(board_of("BDC00")) is watch.board(board_of("BDC15"))
    assert watch.board(board_of("ADC07")) is not watch.board(board_of("BDC00"))


def test_a_board_may_be_still_for_as_long_as_the_settings_say(watch: InfraredWatch) -> None:
    assert watch.check_frozen(10.0 + FROZEN_S - 0.01, driving=True) == ""
    assert watch.check_frozen(10.0 + FROZEN_S, driving=True) != ""


@pytest.mark.parametrize(("alive", "frozen"), [("ADC00", "BDC*"), ("BDC00", "ADC*")])
def test_the_one_that_is_frozen_is_named(watch: InfraredWatch, alive: str, frozen: str) -> None:
    assert watch.check_frozen(11.0, driving=True) == ""
    watch.board(board_of(alive)).still_s = 0.0
    assert frozen in watch.check_frozen(12.0, driving=True)


def test_boards_that_change_are_alive(watch: InfraredWatch) -> None:
    for tick in range(1000):
        now_s = 10.0 + tick * 0.01
        if tick % 140 == 0:
            watch.board(board_of("ADC07")).still_s = watch.board(board_of("BDC00")).still_s = 0.0
        assert watch.check_frozen(now_s, driving=True) == ""


def test_time_in_which_the_robot_stands_does_not_count(watch: InfraredWatch) -> None:
    assert watch.check_frozen(50.0, driving=False) == ""
    assert watch.check_frozen(50.0 + FROZEN_S - 0.01, driving=True) == ""
    assert watch.check_frozen(60.0, driving=False) == ""
    assert watch.check_frozen(60.005, driving=True) == ""


def test_a_stop_in_between_does_not_make_a_board_alive(watch: InfraredWatch) -> None:
    assert watch.check_frozen(10.0 + FROZEN_S - 0.01, driving=True) == ""
    assert watch.check_frozen(60.0, driving=False) == ""
    assert watch.check_frozen(60.02, driving=True) != ""
    assert watch.check_frozen(70.0, driving=False) == ""
    assert watch.check_frozen(70.01, driving=True) != ""
    watch.board(board_of("ADC07")).still_s = watch.board(board_of("BDC00")).still_s = 0.0
    assert watch.check_frozen(70.02, driving=True) == ""


def test_a_clock_that_runs_backwards_takes_nothing_back(watch: InfraredWatch) -> None:
    assert watch.check_frozen(11.0, driving=True) == ""
    assert watch.check_frozen(1.0, driving=True) == ""
    assert watch.check_frozen(1.0 + FROZEN_S - 1.0, driving=True) != ""


def test_a_robot_with_sensors_on_one_board_has_no_other() -> None:
    watch = InfraredWatch(map(board_of, ("BDC01", "BDC02")), FROZEN_S)
    assert watch.check_frozen(5.0, driving=True) == ""  # the time before is unknown
    assert "second controller" in watch.check_frozen(5.0 + FROZEN_S, driving=True)
    watch.board(board_of("BDC02")).still_s = 0.0
    assert watch.check_frozen(5.0 + FROZEN_S, driving=True) == ""
