"""Streams: what a bad teacher, bad sensors, bad clocks and a bad bus do to a guard, tick by tick, drawn in bulk."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hal.kurt2_settings import Kurt2Settings, SpeedMode
from hal.robot_settings import BumperEnd, BumperSettings, GuardSettings
from tests.hal.helpers import ROBOT

Floats = NDArray[np.float64]
Flags = NDArray[np.bool_]
Bytes = NDArray[np.int64]

TICKS_PER_STREAM = 100


@dataclass(frozen=True, eq=False)
class Streams:
    """Streams against one robot; every array is (streams, ticks), times in s, speeds in m/s.

    Within a tick things happen in the order of the fields from `carries` on; `signal` and `refuses` meet the frames
    that go out meanwhile.
    """

    robot: Kurt2Settings
    receives_own_frames: bool
    """The bus tells when it has carried a frame."""
    left_m_s: Floats
    right_m_s: Floats
    now_s: Floats
    sensed_at_s: Floats
    decided_at_s: Floats
    infrared_age_s: Floats
    encoder_age_s: Floats
    bumper_age_s: Floats
    bumpers: Bytes
    watchdog_s: Floats
    """The watchdog's clock when it looks; it is beaten at the end of the tick."""
    carries: Flags
    """The bus carries what waits. Without it nothing is confirmed."""
    stop: Flags
    release: Flags
    stop_again: Flags
    hangs: Flags
    """The tick does not beat the watchdog."""
    early_signal: Flags
    """A signal handler stops the robot while the tick decides, just after it has read everything but the bumpers."""
    signal: Flags
    """A signal handler stops the robot while the tick's frame is being sent."""
    refuses: Flags
    """The bus refuses every frame of this tick."""

    @property
    def shape(self) -> tuple[int, int]:
        """Streams and ticks."""
        streams, ticks = self.now_s.shape
        return streams, ticks


@np.errstate(invalid="ignore", over="ignore")  # none of a time less none of an age is meant
def draw_streams(seed: int, streams: int, ticks: int = TICKS_PER_STREAM) -> Streams:
    """Streams of a seed, against a robot whose settings belong to the seed as well."""
    chance = _Chance(np.random.default_rng([seed, 4]), (streams, ticks))
    robot = _robot(chance.generator)
    limits = robot.guard
    now_s, backwards = _times(chance, robot.cycle_s)
    left_m_s, right_m_s = _wishes(chance, limits, robot.cycle_s)
    stormy = chance.streams(0.2)
    receives_own_frames = bool(chance.generator.random() < 0.5)
    stalls = chance.spells(0.2, starts=0.05, ends=0.2)
    signal = chance.ticks(0.002)
    refuses = ~signal & chance.spells(0.15, starts=0.02, ends=0.5)
    lag_s = chance.pick(
        (0.6, np.zeros(chance.shape)),
        (0.2, chance.generator.uniform(0.0, 0.4 * limits.stale_infrared_s, chance.shape)),
        (0.2, chance.rarely(0.1, chance.near(limits.stale_infrared_s), otherwise=0.0)),
    )
    decided_ago_s = chance.pick(
        (0.6, chance.generator.uniform(0.0, 0.01, chance.shape) * (limits.command_age_s / 0.02)),
        (0.4, chance.rarely(0.1, chance.near(limits.command_age_s), otherwise=0.0)),
    )
    return Streams(
        robot=robot,
        receives_own_frames=receives_own_frames,
        left_m_s=left_m_s,
        right_m_s=right_m_s,
        now_s=now_s,
        # Now and then the clock is asked twice across a jump.
        sensed_at_s=_spoiled(chance, now_s - lag_s + chance.rarely(0.02, backwards, otherwise=0.0)),
        decided_at_s=_spoiled(chance, now_s - decided_ago_s),
        infrared_age_s=_ages(chance, limits.stale_infrared_s),
        encoder_age_s=_ages(chance, limits.stale_encoder_s),
        bumper_age_s=_ages(chance, limits.stale_bumper_s),
        bumpers=np.where(
            chance.spells(0.3, starts=0.05, ends=0.2), chance.levels(0.1, chance.generator.integers(0, 256, 8)), 0
        ).astype(np.int64),
        watchdog_s=_watchdog_times(chance, limits.ticks_ceased_s),
        carries=~stalls,
        stop=chance.ticks(0.002) | (stormy & chance.ticks(0.3)),
        release=chance.ticks(0.1) | (stormy & chance.ticks(0.4)),
        stop_again=stormy & chance.ticks(0.1),
        hangs=chance.spells(0.15, starts=0.02, ends=0.1),
        early_signal=chance.ticks(0.002) & ~refuses & ~signal,
        signal=signal,
        refuses=refuses,
    )


class _Chance:
    """Draws whole arrays of one shape."""

    def __init__(self, generator: np.random.Generator, shape: tuple[int, int]) -> None:
        self.generator = generator
        self.shape = shape

    def streams(self, share: float) -> Flags:
        """Return a mask of whole streams."""
        return self.generator.random((self.shape[0], 1)) < share

    def ticks(self, share: float) -> Flags:
        """Return a mask of single ticks."""
        return self.generator.random(self.shape) < share

    def spells(self, share: float, *, starts: float, ends: float) -> Flags:
        """Return spells in a share of the streams, which start and end with these chances per tick."""
        changes = np.where(self.ticks(starts), 1, np.where(self.ticks(ends), -1, 0))
        last_change = np.maximum.accumulate(np.where(changes != 0, np.arange(self.shape[1]), 0), axis=1)
        return self.streams(share) & (np.take_along_axis(changes, last_change, axis=1) > 0)

    def levels(self, changes: float, values: NDArray[np.int64] | Floats) -> Floats:
        """Values that hold for a while and then step to another one."""
        last_change = np.maximum.accumulate(np.where(self.ticks(changes), np.arange(self.shape[1]), 0), axis=1)
        drawn = values[self.generator.integers(0, len(values), self.shape)]
        return np.take_along_axis(drawn, last_change, axis=1).astype(float)

    def pick(self, *choices: tuple[float, Floats]) -> Floats:
        """Pick one of several arrays for each stream, by weight."""
        weights = np.array([weight for weight, _ in choices])
        which = self.generator.choice(len(choices), size=(self.shape[0], 1), p=weights / weights.sum())
        arrays = [np.broadcast_to(array, self.shape) for _, array in choices]
        return np.choose(np.broadcast_to(which, self.shape), arrays)

    def rarely(self, share: float, array: Floats, *, otherwise: float) -> Floats:
        """Return the array in single ticks only."""
        return np.where(self.ticks(share), array, otherwise)

    def near(self, limit_s: float) -> Floats:
        """Ages about a limit: a hair to either side, far beyond, before their time, none at all."""
        hair = self.generator.choice([-1e-3, -1e-6, 1e-6, 1e-3], size=self.shape)
        odd = self.generator.choice([limit_s * 3, 10.0, 1e9, np.inf, np.nan, -1e-6, -limit_s, -np.inf], size=self.shape)
        return np.where(self.generator.random(self.shape) < 0.6, limit_s * (1.0 + hair), odd)


def _robot(generator: np.random.Generator) -> Kurt2Settings:
    """Return the shipped robot in one of its modes, or one with other limits, another cycle and other bumpers."""
    modes = list(SpeedMode)
    mode = modes[generator.integers(len(modes))]
    if generator.random() < 0.4:
        return ROBOT.model_copy(update={"can": ROBOT.can.model_copy(update={"speed_mode": mode})})
    cycle_s = float(generator.choice([0.005, 0.01, 0.02, 0.05]))

    def between(low: float, high: float) -> float:
        return float(np.exp(generator.uniform(np.log(low), np.log(high))))

    drawn = {
        "maximum_speed_m_s": between(0.02, ROBOT.motors.maximum_speed_m_s),
        "acceleration_m_s2": between(0.05, 20.0),
        "braking_m_s2": between(0.05, 20.0),
        "stale_infrared_s": between(0.02, 1.0),
        "stale_encoder_s": between(0.02, 1.0),
        "stale_bumper_s": between(0.02, 1.0),
        "command_age_s": between(0.005, 0.02),
        "ticks_ceased_s": between(0.05, 1.0),
    }
    ends = [BumperEnd.FRONT if front else BumperEnd.REAR for front in generator.random(generator.integers(0, 9)) < 0.5]
    return ROBOT.model_copy(
        update={
            "cycle_s": cycle_s,
            "can": ROBOT.can.model_copy(update={"speed_mode": mode}),
            "guard": GuardSettings(**{**ROBOT.guard.model_dump(), **drawn}),
            "bumpers": tuple(BumperSettings(name=f"bumper {at}", end=end) for at, end in enumerate(ends)),
        }
    )


def _times(chance: _Chance, cycle_s: float) -> tuple[Floats, Floats]:
    """Return the times of the ticks, and how far each was set back."""
    generator = chance.generator
    steps_s = chance.pick(
        (0.5, np.full(chance.shape, cycle_s)),
        (0.2, cycle_s * generator.uniform(0.5, 1.5, chance.shape)),
        (0.2, np.where(chance.ticks(0.1), generator.uniform(0.0, 30.0, chance.shape) * cycle_s, cycle_s)),
        (0.1, np.where(chance.ticks(0.2), 0.0, cycle_s)),
    )
    backwards = np.where(chance.streams(0.1) & chance.ticks(0.05), generator.uniform(0.0, 0.5, chance.shape), 0.0)
    start_s = generator.choice([0.0, 1.0, 5e4], size=(chance.shape[0], 1))
    now_s = start_s + np.cumsum(steps_s - backwards, axis=1)
    none = generator.choice([np.nan, np.inf, -np.inf, -1e300, 1e300], size=chance.shape)
    return np.where(chance.streams(0.05) & chance.ticks(0.05), none, now_s), backwards


def _spoiled(chance: _Chance, times_s: Floats) -> Floats:
    """Return times of which a few are missing or in the future."""
    odd = chance.generator.choice([np.nan, np.inf, -np.inf, 1e300], size=chance.shape)
    ahead = times_s + chance.generator.choice([1e-6, 0.01, 10.0], size=chance.shape)
    spoiled = np.where(chance.ticks(0.5), odd, ahead)
    return np.where(chance.streams(0.05) & chance.ticks(0.1), spoiled, times_s)


def _ages(chance: _Chance, limit_s: float) -> Floats:
    """Ages of a kind of frames: mostly fresh, frames lost, silent for a while, about the limit."""
    silent = chance.spells(0.9, starts=0.03, ends=0.2)
    at = np.arange(chance.shape[1])
    silent_ticks = at - np.maximum.accumulate(np.where(silent, 0, at), axis=1)
    return chance.pick(
        (0.6, np.zeros(chance.shape)),
        (0.2, chance.rarely(0.3, np.full(chance.shape, 0.6 * limit_s), otherwise=0.0)),
        (0.1, (0.3 * limit_s * silent_ticks).astype(np.float64)),
        (0.1, chance.rarely(0.1, chance.near(limit_s), otherwise=0.0)),
    )


def _watchdog_times(chance: _Chance, ticks_ceased_s: float) -> Floats:
    late = chance.streams(0.1) & chance.ticks(0.05)
    steps_s = np.where(late, chance.generator.uniform(0.5, 3.0, chance.shape) * ticks_ceased_s, 0.05 * ticks_ceased_s)
    times_s = 10.0 + np.cumsum(steps_s, axis=1)
    return np.where(chance.streams(0.02) & chance.ticks(0.05), np.nan, times_s)


def _wishes(chance: _Chance, limits: GuardSettings, cycle_s: float) -> tuple[Floats, Floats]:
    """Wished speeds of both sides."""
    left, right = _wish(chance, limits, cycle_s), _wish(chance, limits, cycle_s)
    right = chance.pick((0.4, right), (0.3, left), (0.2, -left), (0.1, 0.5 * left))
    return _with_none(chance, left), _with_none(chance, right)


def _with_none(chance: _Chance, speeds: Floats) -> Floats:
    odd = chance.generator.choice([np.nan, np.inf, -np.inf], size=chance.shape)
    return np.where(chance.streams(0.1) & chance.ticks(0.05), odd, speeds)


def _wish(chance: _Chance, limits: GuardSettings, cycle_s: float) -> Floats:
    generator, shape = chance.generator, chance.shape
    fastest = limits.maximum_speed_m_s
    tick = np.arange(shape[1])
    period = generator.integers(2, 60, (shape[0], 1))
    phase = ((tick + generator.integers(0, 60, (shape[0], 1))) % period) / period
    slope = generator.choice([0.5, 0.99, 1.01, 2.0], size=(shape[0], 1)) * limits.acceleration_m_s2 * cycle_s
    levels = np.array([0.0, fastest, -fastest, 2 * fastest, -2 * fastest, 0.01, -0.01, 1e-9, -1e-9, 0.3, -0.3, 0.1])
    huge = generator.choice([-1.0, 1.0], size=shape) * 10.0 ** generator.uniform(-320, 308, shape)
    return chance.pick(
        (0.3, chance.levels(0.05, levels)),
        (0.1, generator.uniform(-1.5 * fastest, 1.5 * fastest, shape)),
        (0.15, fastest * (4.0 * np.abs(phase - 0.5) - 1.0) * 1.2),  # a sawtooth over the limits
        (0.1, np.where(phase < 0.5, fastest, -fastest)),
        (0.15, np.minimum(slope * (tick % 80), 1.1 * fastest)),
        (0.1, huge),
        (0.1, np.full(shape, fastest) * generator.uniform(-1.0, 1.0, (shape[0], 1))),
    )
