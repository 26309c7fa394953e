"""Episodes of a recorded run: evenly spaced frames of state, action, reward and intervention, as arrays."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from hal.robot_settings import RobotSettings
from kurt2rt.core.decision.decision import ASKING, DecisionCause
from kurt2rt.core.rla.events import Lesson, RlaRewarded
from kurt2rt.core.rla.rla import CRITIC
from kurt2rt.runs.recording.entries import TickEntry
from kurt2rt.runs.recording.recording_error import RecordingError
from kurt2rt.runs.replay.run import Run

LONGEST_REPEAT_S = 0.25
"""Longest gap of missing ticks that repeats the frame before it; a longer one ends the episode."""
LONGEST_EPISODE_S = 1000.0
"""Length at which the next episode begins. LeRobot's float32 time stamps have steps of 0.06 ms up to 1 024 s and larger
ones after them; it refuses frames that are more than 0.1 ms from evenly spaced.
"""
_BLOCK_ROWS = 1000

Column = NDArray[Any]


@dataclass(frozen=True, slots=True)
class Feature:
    """Type of one column of a data set: numpy's name of it, and the names of a frame's values.

    Without names a frame has one value.
    """

    dtype: str
    names: tuple[str, ...] | None = None

    @property
    def length(self) -> int:
        """Number of values in a frame."""
        return 1 if self.names is None else len(self.names)


@dataclass(frozen=True, slots=True)
class Episode:
    """Frames of one run without a gap, in time order, for a data set (episode of LeRobotDataset v3.0).

    A missing tick or 1 000 s end it, and the next one begins.
    """

    columns: dict[str, Column]
    """Values by feature: (frames,), or (frames, length) for a feature with names."""
    tasks: tuple[str, ...]
    """Different tasks that the robot had, in the order of their beginning."""
    task_of_frame: NDArray[np.int64]
    """Index into `tasks`, (frames,)."""
    first_tick: int
    began_s: float
    """Time of the first frame since the run began, in s."""

    @property
    def frames(self) -> int:
        """Number of frames, one for each exported tick."""
        return len(self.task_of_frame)


def features_of(robot: RobotSettings) -> dict[str, Feature]:
    """Return the features of every episode of a robot, by LeRobot's names."""
    sides = ("left_m_s", "right_m_s")
    sensors = (
        *(f"{name}_counts" for name in robot.infrared.names),
        *(f"bumper_{each.name}" for each in robot.bumpers),
    )
    # LeRobot's policies want a picture or a state of the environment next to that of the robot.
    return {
        "observation.state": Feature("float32", sides),
        "observation.environment_state": Feature("float32", sensors),
        "action": Feature("float32", sides),
        "next.reward": Feature("float32"),
        "next.done": Feature("bool"),
        "complementary_info.is_intervention": Feature("bool"),
        "complementary_info.asks": Feature("bool"),
        "complementary_info.lessons": Feature("int64"),
        "complementary_info.applied": Feature("float32", sides),
    }


def ticks_per_frame(robot: RobotSettings, fps: int) -> int:
    """Return the number of ticks from frame to frame at `fps` frames a second.

    Raises RecordingError if frames would not fall on ticks.
    """
    ticks_per_s = round(1 / robot.cycle_s)
    if fps < 1 or ticks_per_s % fps:
        allowed = [str(each) for each in range(1, ticks_per_s + 1) if ticks_per_s % each == 0]
        raise RecordingError(
            f"the robot has {ticks_per_s} ticks a second, of which {fps} frames a second take no whole number each",
            where="--fps",
            do=f"give one of {', '.join(allowed)}",
        )
    return ticks_per_s // fps


def read_episodes(run: Run, every: int, on_entry: Callable[[TickEntry], None] = lambda _: None) -> Iterator[Episode]:
    """Yield the episodes of a run, the next one after LONGEST_EPISODE_S, and after a gap longer than LONGEST_REPEAT_S.

    A frame has the newest readings and decision at its tick, and counts lessons and rewards up to the next frame.

    Args:
        run: opened with `partial` if its beginning may be missing.
        every: number of ticks from frame to frame.
        on_entry: called with each tick.

    Raises:
        RecordingError: the run cannot be read.
    """
    longest = round(LONGEST_REPEAT_S / run.robot.cycle_s)
    whole_frames = round(LONGEST_EPISODE_S / run.robot.cycle_s) // every * every
    stretch = _Stretch(run.robot)
    for entry in run.partial_entries():
        if stretch.newest is not None and not (
            0 < entry.tick - stretch.newest <= longest and entry.tick - stretch.first < whole_frames
        ):
            yield stretch.episode(every)
            stretch = _Stretch(run.robot)
        stretch.add(entry, _task_text(run.task.name, entry.behaviour), run.elapsed_s(entry))
        on_entry(entry)
    if stretch.newest is not None:
        yield stretch.episode(every)


def _task_text(task: str, behaviour: str) -> str:
    text = f"{task}: {behaviour}" if behaviour else task
    return text.replace("_", " ")


@dataclass(slots=True)
class _Stretch:
    """Ticks without a long gap: one row each, packed in blocks."""

    robot: RobotSettings
    first: int = 0
    """First tick."""
    newest: int | None = None
    """Newest tick; None before the first."""
    began_s: float = 0.0
    _blocks: list[Column] = field(default_factory=list)
    _rows: list[tuple[Any, ...]] = field(default_factory=list)
    _rewards: list[tuple[int, int]] = field(default_factory=list)
    """Tick of the decision, and its reward."""
    _tasks: dict[str, int] = field(default_factory=dict)

    def add(self, entry: TickEntry, task: str, since_s: float) -> None:
        if self.newest is None:
            self.first, self.began_s = entry.tick, since_s
        self.newest = entry.tick
        readings, decision = entry.readings, entry.decision
        speed = 1.0 if entry.lesson_speed is None else entry.lesson_speed
        taught = [each for each in entry.events if isinstance(each, Lesson) and each.origin.teacher != CRITIC]
        self._rewards += [(each.decided_at_tick, each.value) for each in taught if isinstance(each, RlaRewarded)]
        self._rows.append(
            (
                entry.tick,
                self._tasks.setdefault(task, len(self._tasks)),
                readings.infrared_counts,
                (readings.encoder_left_ticks, readings.encoder_right_ticks),
                readings.bumpers,
                tuple(each * speed for each in decision.wheel_speeds),
                tuple(entry.grant.wheel_speeds),
                decision.cause is DecisionCause.TEACHER,
                decision.cause in ASKING,
                len(taught),
            )
        )
        if len(self._rows) == _BLOCK_ROWS:
            self._pack()

    def episode(self, every: int) -> Episode:
        """Return the stretch as frames, one for each `every` ticks."""
        self._pack()
        rows = np.concatenate(self._blocks)
        first = self.first
        frames = (int(rows["tick"][-1]) - first) // every + 1
        # The newest row at or before each frame's tick; the frame of each row.
        newest = np.searchsorted(rows["tick"], first + every * np.arange(frames), side="right") - 1
        frame_of = (rows["tick"] - first) // every
        at = rows[newest]
        travelled = np.cumsum(rows["encoders"], axis=0, dtype=np.int64)[newest]
        encoders = np.diff(travelled, axis=0, prepend=0)
        period_s = every * self.robot.cycle_s
        speeds = encoders * self.robot.geometry.metres_per_tick / period_s
        speeds[0] *= every  # of one tick only
        bits = at["bumpers"][:, None] >> np.arange(len(self.robot.bumpers)) & 1
        reward = np.zeros(frames, np.float32)
        for tick, value in self._rewards:
            if tick >= first:
                reward[(tick - first) // every] += value
        by_hand, asks = np.zeros(frames, bool), np.zeros(frames, bool)
        lessons = np.zeros(frames, np.int64)
        np.logical_or.at(by_hand, frame_of, rows["by_hand"])
        np.logical_or.at(asks, frame_of, rows["asks"])
        np.add.at(lessons, frame_of, rows["lessons"])
        columns = {
            "observation.state": speeds,
            "observation.environment_state": np.hstack([at["counts"], bits], dtype=np.float32),
            "action": at["asked"],
            "next.reward": reward,
            "next.done": np.arange(frames) == frames - 1,
            "complementary_info.is_intervention": by_hand,
            "complementary_info.asks": asks,
            "complementary_info.lessons": lessons,
            "complementary_info.applied": at["applied"],
        }
        typed = {
            name: np.nan_to_num(columns[name].astype(kind.dtype)) if kind.dtype == "float32" else columns[name]
            for name, kind in features_of(self.robot).items()
        }
        return Episode(typed, tuple(self._tasks), at["task"].astype(np.int64), first, self.began_s)

    def _pack(self) -> None:
        if self._rows:
            self._blocks.append(np.array(self._rows, self._type()))
            self._rows.clear()

    def _type(self) -> np.dtype[Any]:
        return np.dtype(
            [
                ("tick", np.int64),
                ("task", np.int16),
                ("counts", np.int16, (len(self.robot.infrared.names),)),
                ("encoders", np.int32, (2,)),
                ("bumpers", np.uint8),
                ("asked", np.float64, (2,)),
                ("applied", np.float64, (2,)),
                ("by_hand", bool),
                ("asks", bool),
                ("lessons", np.int16),
            ]
        )
