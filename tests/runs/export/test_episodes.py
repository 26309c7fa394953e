"""Episodes of recorded runs."""

from dataclasses import replace

import numpy as np
import pytest

from hal.robot_settings import load_robot
from kurt2rt.core.decision.decision import DecisionCause
from kurt2rt.core.rla.events import RlaRewarded
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.runs.export import episodes
from kurt2rt.runs.export.episodes import LONGEST_EPISODE_S, Episode, read_episodes, ticks_per_frame
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run, RunSource
from tests.runs.replay.stored_runs import stored

ENTRIES = tuple(stored("walls").entries())
STATE, SENSORS, ACTION = "observation.state", "observation.environment_state", "action"


def run_of(entries: tuple[TickEntry, ...]) -> Run:
    whole = stored("walls")
    return Run("part", whole.head, whole._attachments, RunSource(lambda: iter(entries)), partial=True)


def only_episode(entries: tuple[TickEntry, ...], every: int = 1) -> Episode:
    (episode,) = read_episodes(run_of(entries), every)
    return episode


def test_frames_of_each_tick_hold_readings_and_speeds() -> None:
    episode = only_episode(ENTRIES)
    robot = load_robot()
    assert episode.frames == len(ENTRIES) == 4400
    assert episode.tasks == ("wall following",)
    for at in (0, 500, 4399):
        entry = ENTRIES[at]
        assert episode.columns[SENSORS][at, :18].tolist() == list(entry.readings.infrared_counts)
        left_m_s = entry.readings.encoder_left_ticks * robot.geometry.metres_per_tick / robot.cycle_s
        assert episode.columns[STATE][at, 0] == pytest.approx(left_m_s)
        assert episode.columns[ACTION][at] == pytest.approx(entry.decision.wheel_speeds)
        assert episode.columns["complementary_info.applied"][at] == pytest.approx(entry.grant.wheel_speeds)
    by_hand = [entry.decision.cause is DecisionCause.TEACHER for entry in ENTRIES]
    assert episode.columns["complementary_info.is_intervention"].tolist() == by_hand
    assert episode.columns["next.done"].nonzero()[0].tolist() == [4399]


def test_lesson_of_the_critic_is_none_of_a_teacher() -> None:
    (entry,) = [each for each in ENTRIES if len(each.events) == 1 and isinstance(each.events[0], RlaRewarded)][:1]
    event = entry.events[0]
    assert isinstance(event, RlaRewarded)
    by_critic = replace(event, origin=replace(event.origin, teacher=CRITIC))
    for events, lessons in (((event,), 1), ((by_critic,), 0), ((event, by_critic), 1)):
        episode = only_episode((entry._replace(events=events),))
        assert episode.columns["complementary_info.lessons"].tolist() == [lessons]


@pytest.mark.parametrize("fps", [0, 30])
def test_frames_between_ticks_are_refused(fps: int) -> None:
    with pytest.raises(RecordingError, match="give one of 1, 2, 4, 5, 10, 20, 25, 50, 100"):
        ticks_per_frame(load_robot(), fps)


@pytest.mark.parametrize("every", [1, 20])
def test_a_long_run_continues_in_the_next_episode(every: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(episodes, "LONGEST_EPISODE_S", 20.0)
    parts = list(read_episodes(run_of(ENTRIES[:1500] + ENTRIES[1510:]), every))
    assert [each.frames * every for each in parts] == [2000, 2000, 400]
    assert [each.first_tick for each in parts] == [1, 2001, 4001]
    assert [each.began_s for each in parts] == pytest.approx([0.0, 20.0, 40.0])
    monkeypatch.undo()
    together = np.concatenate([each.columns[SENSORS] for each in parts])
    assert (together == only_episode(ENTRIES[:1500] + ENTRIES[1510:], every).columns[SENSORS]).all()


@pytest.mark.parametrize("fps", [each for each in range(1, 101) if 100 % each == 0])
def test_time_stamps_of_the_longest_episode_are_even(fps: int) -> None:
    stamps_s = (np.arange(LONGEST_EPISODE_S * fps) / fps).astype(np.float32)
    assert abs(np.diff(stamps_s) - 1 / fps).max() < 1e-4
