"""Slow lessons in the tick: the guard is asked for a share of the decided speeds, only while a teacher teaches."""

import pytest

from hal.robot import STANDSTILL, SensorReadings, WheelSpeeds
from kurt2rt.core.outcome import Outcome, RefusalCode
from kurt2rt.core.rla.rla import Phase
from kurt2rt.core.teaching.commands import Appraise, Drive, HoldAction, Reward, SetLessonSpeed
from tests.core.test_tick import BACK, FORWARD, Corridor, averages
from tests.teacher.helpers import resume, set_phase, stop, teach

SHARE = 0.6
SLOW_FORWARD = WheelSpeeds(SHARE * FORWARD.left_m_s, SHARE * FORWARD.right_m_s)


def slow(share: float = SHARE, teacher: str = "Ann") -> SetLessonSpeed:
    return SetLessonSpeed(f"slow-{share}-{teacher}", teacher, round(100 * share))


@pytest.fixture
def driving() -> Corridor:
    """Return a robot that drives forward in a slow lesson."""
    corridor = Corridor()
    corridor.run(100, slow(), teach("forward", "first"))
    return corridor


def test_slow_lesson_asks_the_guard_for_a_share_of_the_speeds(driving: Corridor) -> None:
    record = driving.run()
    assert (record.decision.wheel_speeds, record.lesson_speed) == (FORWARD, SHARE)
    assert driving.robot.driven[-1] == SLOW_FORWARD


@pytest.mark.parametrize("phase", [Phase.REINFORCEMENT, Phase.AUTONOMOUS])
def test_later_phases_drive_at_full_speed(driving: Corridor, phase: Phase) -> None:
    record = driving.run(100, set_phase(phase))
    assert (driving.robot.driven[-1], record.lesson_speed) == (FORWARD, 1.0)


def test_exam_drives_at_full_speed() -> None:
    corridor = Corridor(asked=False)
    corridor.run(100, slow(), teach("forward", "first"))
    assert corridor.run().decision.wheel_speeds == corridor.robot.driven[-1] == FORWARD


def test_held_action_is_slow_and_manual_drive_is_not(driving: Corridor) -> None:
    driving.run(100, HoldAction("Ann", driving.ticks + 1, 7, "back"))
    assert driving.robot.driven[-1] == WheelSpeeds(SHARE * BACK.left_m_s, SHARE * BACK.right_m_s)
    driving.run(100, Drive("Ann", driving.ticks + 1, 8, 0.2, 0.1))
    assert driving.robot.driven[-1] == WheelSpeeds(0.2, 0.1)


def test_stopped_robot_stands_in_a_slow_lesson(driving: Corridor) -> None:
    record = driving.run(100, stop())
    assert (driving.robot.driven[-1], record.lesson_speed) == (STANDSTILL, 1.0)
    driving.run(100, resume())
    assert driving.robot.driven[-1] == SLOW_FORWARD


@pytest.mark.parametrize("share", [0.0, 0.19, 1.01, -1.0])
def test_lesson_speed_out_of_range_is_refused(driving: Corridor, share: float) -> None:
    (result,) = driving.run(100, slow(share)).results
    assert result.outcome == Outcome.of(RefusalCode.NO_LESSON_SPEED, percent=round(100 * share), least=20)
    assert driving.run().lesson_speed == SHARE


def test_averages_of_a_slow_lesson_are_those_of_the_way() -> None:
    """A way at 0.5 in twice as many ticks leaves the averages of the way at full speed."""
    found = []
    for share, each in ((1.0, 1), (0.5, 2)):
        corridor = Corridor()
        corridor.run(100, slow(share), teach("forward", "first"))
        corridor.run(100)
        for counts in range(101, 121):
            for _ in range(each):
                record = corridor.run(counts)
        found.append(averages(record))
    assert found[1] == pytest.approx(found[0], abs=0.11)


class DrivenTicks:
    """Watch for broken sensors that notes in which ticks it is told that the robot drove."""

    broken = places = ()

    def __init__(self) -> None:
        self.drove: list[bool] = []

    def update(self, _readings: SensorReadings, *, driving: bool) -> tuple[()]:
        self.drove.append(driving)
        return ()


def test_sensors_are_watched_on_the_clock_of_the_way(driving: Corridor, monkeypatch: pytest.MonkeyPatch) -> None:
    """An edge that one sensor sees for longer is no phantom: at 0.6 one stopped the robot of seed 925 for good."""
    watch = DrivenTicks()
    monkeypatch.setattr(driving.tick, "_sensor_watch", watch)
    monkeypatch.setattr(driving.tick, "_substitute", lambda *_: ())
    for _ in range(100):
        driving.run()
    assert sum(watch.drove) == pytest.approx(60, abs=1)


@pytest.mark.parametrize(
    "signal", [Reward("signal", "Ann", -1), Reward("signal", "Ann", 1, 2)], ids=["present tick", "earlier tick"]
)
def test_reward_of_a_slow_tick_is_refused(driving: Corridor, signal: Reward) -> None:
    driving.run()
    (result,) = driving.run(100, signal).results
    assert result.code is RefusalCode.DROVE_SLOWLY


def test_appraisal_without_a_critic_is_refused_for_that(driving: Corridor) -> None:
    (result,) = driving.run(100, Appraise("signal", "Ann", "bad")).results
    assert result.code is RefusalCode.NO_CRITIC
