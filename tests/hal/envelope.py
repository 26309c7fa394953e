"""Motion envelope, written independently: rules for CONTROL frames under any requests and readings.

Nothing here calls the guard, the watchdog or the codec of CONTROL. Every rule is about the frames that go out, given
what came in. The guard's set points are known from its frames to their resolution only, so each side's is followed as
an interval.
"""

from typing import Final, NamedTuple

import numpy as np

from hal.robot_settings import BumperEnd
from tests.hal.control_bytes import Side, read_control
from tests.hal.playing import AGAIN, FIRST, SIGNAL, Played
from tests.hal.streams import Bytes, Flags, Floats, Streams

OLDEST_COMMAND_S = 0.02
"""No robot here may be told to move by an older decision than this."""
_SLACK_S = 1e-9
_SLACK_M_S = 1e-9

STANDS_FOR: Final = (
    *("not a number", "clock ran backwards", "command too old", "range sensors stale", "encoder stale"),
    "bumper stale",
)
"""Reasons to stand for one tick."""
APPROACHES_FOR: Final = ("speed limit", "front bumper", "rear bumper", "slew limit")
"""Reasons to drive otherwise than was wanted."""


class Violation(NamedTuple):
    """One tick of one stream in which the envelope did not hold."""

    stream: int
    tick: int
    rule: str


@np.errstate(invalid="ignore", over="ignore")  # none of a time less none of an age is meant
def violations(streams: Streams, played: Played) -> list[Violation]:
    """Return the places where a played stream left the envelope."""
    return _Rules(streams, played).check()


class _Moment(NamedTuple):
    """One tick of all streams, as far as both sides share it."""

    tick: int
    tells: Flags
    """A set point went out first, not a brake."""
    stay: Flags
    """There is a reason to stand."""
    front: Flags
    rear: Flags
    elapsed_s: Floats
    """Time since the last set point, at most two cycles."""
    first: Bytes
    """Number of the frame."""


class _Reached(NamedTuple):
    """One side after a tick."""

    told: Side
    """Set points of the frame; standstill without a frame."""
    sure_low_m_s: Floats
    """Lowest speed that the set point can reach from each of its possible values."""
    sure_high_m_s: Floats


class _Interval:
    """Interval of one side's set point in each stream, in m/s."""

    def __init__(self, streams: int) -> None:
        self.low = np.zeros(streams)
        self.high = np.zeros(streams)

    def stand(self, where: Flags) -> None:
        """Set the interval to zero."""
        self.low[where] = self.high[where] = 0.0


class _Rules:
    """The rules, applied tick by tick to all streams at once."""

    def __init__(self, streams: Streams, played: Played) -> None:
        self._streams = streams
        self._played = played
        self._limits = streams.robot.guard
        self._frames = read_control(streams.robot, played.payloads)
        count = streams.shape[0]
        self._latched = np.full(count, "", dtype=object)
        self._last_s = np.full(count, -np.inf)
        self._beat_s = np.full(count, np.nan)
        self._beaten = np.zeros(count, dtype=bool)
        self._intervals = _Interval(count), _Interval(count)
        words = {*STANDS_FOR, *APPROACHES_FOR}
        self._said = {word: np.array([word in reasons for reasons in played.reasons_of]) for word in words}
        self._known = np.array([words.issuperset(reasons) for reasons in played.reasons_of])
        only = [reasons[0] if len(reasons) == 1 else "" for reasons in played.reasons_of]
        self._only = np.array(only, dtype=object)
        self._found: list[Violation] = []

    def check(self) -> list[Violation]:
        if self._played.strange:
            self._found.append(Violation(0, 0, "a frame goes out that is no CONTROL frame"))
        for tick in range(self._streams.shape[1]):
            self._check_stops(tick)
            self._check_driving(tick)
            beats = ~self._streams.hangs[:, tick]
            self._beat_s = np.where(beats, self._streams.watchdog_s[:, tick], self._beat_s)
            self._beaten |= beats
        self._check_failures_are_counted()
        return self._found

    def _never(self, rule: str, where: Flags, tick: int) -> None:
        self._found.extend(Violation(int(stream), tick, rule) for stream in np.flatnonzero(where))

    def _check_stops(self, tick: int) -> None:
        """Check that a stop latches and brakes at once, and that only a release ends it."""
        streams, played = self._streams, self._played
        stop, again = streams.stop[:, tick], streams.stop_again[:, tick]
        silent_s = streams.watchdog_s[:, tick] - self._beat_s
        ceased = self._beaten & ~(silent_s <= self._limits.ticks_ceased_s)
        self._latch(FIRST, stop)
        self._latched[streams.release[:, tick]] = ""
        self._latch(AGAIN, again)
        self._latch("ticks ceased", ceased)
        first, sent = played.first_frame[:, tick], played.first_of_drive[:, tick] - played.first_frame[:, tick]
        self._never("a stop does not send a brake at once", sent != stop.astype(int) + again + ceased, tick)
        self._expect_brakes("a stop sends something else than a brake", first, sent, np.full_like(sent, -1), tick)

    def _check_driving(self, tick: int) -> None:
        """One set point where nothing is latched, and a brake as soon as something is."""
        streams, played = self._streams, self._played
        signal, refuses = streams.signal[:, tick], streams.refuses[:, tick]
        free = self._latched == ""
        self._latch("bus blocked", free & (played.waiting[:, tick] >= 2))
        tells = self._latched == ""
        first, sent = played.first_of_drive[:, tick], played.end[:, tick] - played.first_of_drive[:, tick]
        now_s = streams.now_s[:, tick]
        reasons = _reasons_to_stand(streams, self._last_s, tick, _SLACK_S)
        stay = np.logical_or.reduce(list(reasons.values()))
        early = played.interrupted[:, tick]
        for interval in self._intervals:
            interval.stand(early)
        # A stop in the middle of a tick brakes by itself, and so does the tick that sees it.
        expected = np.where(tells, 1 + 2 * signal + 2 * early + refuses, 1 + signal + early)
        self._never("not one frame a tick", sent != expected, tick)
        # A stop while it decides brakes before the set point goes out, and again behind it.
        self._expect_brakes("latched, and no brake goes out", first, sent, np.where(tells, early, -1), tick)
        at = np.minimum(first + early, len(self._played.payloads) - 1)
        self._never("a frame is no set point of the robot's mode", tells & ~self._frames.set_points[at], tick)
        longest_s = 2.0 * streams.robot.cycle_s
        elapsed_s = np.nan_to_num(np.clip(now_s - self._last_s, 0.0, longest_s))
        front, rear = self._pressed(BumperEnd.FRONT, tick), self._pressed(BumperEnd.REAR, tick)
        moment = _Moment(tick, tells, stay, front, rear, elapsed_s, at)
        self._check_standing(moment, reasons)
        left = self._check_side(moment, 0)
        right = self._check_side(moment, 1)
        self._latch("bus lost", tells & refuses)
        self._latch(SIGNAL, signal | early)
        self._check_grant(moment, left, right, _reasons_to_stand(streams, self._last_s, tick, -_SLACK_S))
        self._last_s = np.where(tells & np.isfinite(now_s), now_s, self._last_s)

    def _latch(self, reason: str, where: Flags) -> None:
        """Check that the first reason stays, and that the wheels start from zero afterwards."""
        self._latched[where & (self._latched == "")] = reason
        for interval in self._intervals:
            interval.stand(where)

    def _expect_brakes(self, rule: str, first: Bytes, count: Bytes, but: Bytes, tick: int) -> None:
        """All of `count` frames from the first on are brakes, but the one of that number."""
        for offset in range(int(count.max(initial=0))):
            here = np.flatnonzero((offset != but) & (offset < count))
            wrong = np.zeros(len(first), dtype=bool)
            wrong[here] = ~self._frames.brakes[first[here] + offset]
            self._never(rule, wrong, tick)

    def _pressed(self, end: BumperEnd, tick: int) -> Flags:
        bits = [bit for bit, bumper in enumerate(self._streams.robot.bumpers) if bumper.end is end]
        pressed: Flags = (self._streams.bumpers[:, tick] & sum(1 << bit for bit in bits)) != 0
        return pressed

    def _check_standing(self, moment: _Moment, reasons: dict[str, Flags]) -> None:
        for side in (self._frames.left.of(moment.first), self._frames.right.of(moment.first)):
            for reason, holds in reasons.items():
                self._never(f"drives on, but: {reason}", moment.tells & holds & ~side.stands, moment.tick)
            moves = moment.tells & ~side.stands
            old_s = self._streams.now_s[:, moment.tick] - self._streams.decided_at_s[:, moment.tick]
            self._never("a command older than 20 ms", moves & ~(old_s <= OLDEST_COMMAND_S + _SLACK_S), moment.tick)

    def _check_side(self, moment: _Moment, number: int) -> _Reached:
        """Speed, bumpers, slew and direction of one side."""
        limits, interval = self._limits, self._intervals[number]
        told = (self._frames.left, self._frames.right)[number].of(moment.first)
        wanted = (self._streams.left_m_s, self._streams.right_m_s)[number][:, moment.tick]
        told = told.where(moment.tells)
        too_fast = np.abs(told.speed_m_s) > limits.maximum_speed_m_s + _SLACK_M_S
        self._never("faster than it may", too_fast, moment.tick)
        self._never("forward against a bumper", moment.front & (told.speed_m_s > 0.0), moment.tick)
        self._never("backward against a bumper", moment.rear & (told.speed_m_s < 0.0), moment.tick)

        # What drives against a bumper is stopped at once, and may start the other way in the same tick.
        lowest, highest = np.where(moment.rear, 0.0, -np.inf), np.where(moment.front, 0.0, np.inf)
        low, high = np.clip(interval.low, lowest, highest), np.clip(interval.high, lowest, highest)
        up, down = limits.acceleration_m_s2 * moment.elapsed_s, limits.braking_m_s2 * moment.elapsed_s
        drives = moment.tells & ~moment.stay & ~told.stands
        beyond = (told.low_m_s > _highest(high, up, down)) | (told.high_m_s < _lowest(low, up, down))
        self._never("further than the slew limits let it", drives & beyond, moment.tick)
        goal = np.where(np.isfinite(wanted), wanted, 0.0)
        away = (told.low_m_s > np.maximum(high, np.maximum(goal, 0.0))) | (
            told.high_m_s < np.minimum(low, np.minimum(goal, 0.0))
        )
        self._never("away from what is wanted", drives & away, moment.tick)

        new_low = np.maximum(_lowest(low, up, down), told.low_m_s)
        new_high = np.minimum(_highest(high, up, down), told.high_m_s)
        # A stop is not slewed: zero may be told in any tick.
        zero_told = (told.low_m_s <= 0.0) & (told.high_m_s >= 0.0)
        jumped = zero_told & (new_low > new_high)
        interval.low = np.where(jumped, 0.0, np.where(zero_told, np.minimum(new_low, 0.0), new_low))
        interval.high = np.where(jumped, 0.0, np.where(zero_told, np.maximum(new_high, 0.0), new_high))
        interval.stand(moment.stay | ~moment.tells)
        return _Reached(told, _lowest(high, up, down), _highest(low, up, down))

    def _check_grant(self, moment: _Moment, left: _Reached, right: _Reached, possible: dict[str, Flags]) -> None:
        """Check that the applied speeds equal those in the frame, and that differences have reasons."""
        played, tick = self._played, moment.tick
        applied = played.applied_left_m_s[:, tick], played.applied_right_m_s[:, tick]
        for speed_m_s, side in zip(applied, (left.told, right.told), strict=True):
            says = np.where(self._latched == "", side.speed_m_s, 0.0)
            self._never("it grants something else than it sends", ~(np.abs(speed_m_s - says) <= _SLACK_M_S), tick)
        latched = self._latched != ""
        number = played.reasons[:, tick]
        self._never("it does not say that it is latched", played.latched[:, tick] != latched, tick)
        self._never("it is latched for another reason", played.latched_because[:, tick] != self._latched, tick)
        self._never("latched, it gives another reason", latched & (self._only[number] != self._latched), tick)

        said = {word: holds[number] & ~latched for word, holds in self._said.items()}
        self._never("it gives a reason that is none", ~latched & ~self._known[number], tick)
        stands = np.logical_or.reduce([said[word] for word in STANDS_FOR])
        for word in STANDS_FOR:
            self._never(f"it stands without cause: {word}", said[word] & ~possible[word], tick)
        self._never("it stands and says not why", ~latched & moment.stay & ~stands, tick)
        self._never("it stands and says more", stands & (self._only[number] == ""), tick)
        self._check_approach(moment, left, right, ~latched & ~moment.stay & ~stands, said)

    def _check_approach(
        self, moment: _Moment, left: _Reached, right: _Reached, free: Flags, said: dict[str, Flags]
    ) -> None:
        """Check that the set point moves as far as the limits allow, and that the limits are given as reasons."""
        streams, tick = self._streams, moment.tick
        wanted = [np.where(free, speeds[:, tick], 0.0) for speeds in (streams.left_m_s, streams.right_m_s)]
        fastest = np.maximum(np.abs(wanted[0]), np.abs(wanted[1]))
        limited = fastest > self._limits.maximum_speed_m_s
        self._never("it does not say rightly: speed limit", free & (said["speed limit"] != limited), tick)
        share = np.where(limited, self._limits.maximum_speed_m_s / np.where(limited, fastest, 1.0), 1.0)
        goals = [speeds * share for speeds in wanted]
        into_front = moment.front & ((goals[0] > 0.0) | (goals[1] > 0.0))
        goals = [np.where(moment.front, np.minimum(goal, 0.0), goal) for goal in goals]
        into_rear = moment.rear & ((goals[0] < 0.0) | (goals[1] < 0.0))
        goals = [np.where(moment.rear, np.maximum(goal, 0.0), goal) for goal in goals]
        self._never("it does not say rightly: front bumper", free & (said["front bumper"] != into_front), tick)
        self._never("it does not say rightly: rear bumper", free & (said["rear bumper"] != into_rear), tick)
        all_in_reach = free.copy()
        for goal, side in zip(goals, (left, right), strict=True):
            says_it = (side.told.low_m_s <= goal) & (goal <= side.told.high_m_s)
            in_reach = (goal == 0.0) | (
                (side.sure_low_m_s + _SLACK_M_S <= goal) & (goal <= side.sure_high_m_s - _SLACK_M_S)
            )
            all_in_reach &= in_reach
            self._never("it holds back what it may grant", free & in_reach & ~says_it, tick)
            self._never("it does otherwise and says not why", free & ~said["slew limit"] & ~says_it, tick)
        self._never("it does not say rightly: slew limit", all_in_reach & said["slew limit"], tick)

    def _check_failures_are_counted(self) -> None:
        for stream, failures in enumerate(self._played.send_failures):
            first, last = self._played.first_frame[stream, 0], self._played.end[stream, -1]
            if failures != int(self._played.refused[first:last].sum()):
                last_tick = self._streams.shape[1] - 1
                self._found.append(Violation(stream, last_tick, "refused frames are not counted"))


def _reasons_to_stand(streams: Streams, last_s: Floats, tick: int, slack_s: float) -> dict[str, Flags]:
    """Return for each reason the streams in which this tick gives it; `last_s` is the time of the last set point.

    Limits are exceeded by more than the slack; with a negative one they may also be missed by so much.
    """
    robot, limits = streams.robot, streams.robot.guard
    now_s = streams.now_s[:, tick]
    sensed_ago_s, decided_ago_s = now_s - streams.sensed_at_s[:, tick], now_s - streams.decided_at_s[:, tick]
    forwards = (now_s - last_s >= -slack_s) & (sensed_ago_s >= -slack_s) & (decided_ago_s >= -slack_s)
    forwards &= np.isfinite(now_s)
    frames = {
        "range sensors stale": (streams.infrared_age_s, limits.stale_infrared_s),
        "encoder stale": (streams.encoder_age_s, limits.stale_encoder_s),
        "bumper stale": (streams.bumper_age_s, limits.stale_bumper_s if robot.bumpers else np.inf),
    }
    reasons = {
        "not a number": ~(np.isfinite(streams.left_m_s[:, tick]) & np.isfinite(streams.right_m_s[:, tick])),
        "clock ran backwards": ~forwards,
        "command too old": ~(decided_ago_s <= limits.command_age_s + slack_s),
    }
    for word, (ages_s, limit_s) in frames.items():
        age_s = ages_s[:, tick]
        reasons[word] = ~((sensed_ago_s + age_s <= limit_s + slack_s) & (age_s >= -slack_s))
    return reasons


def _highest(from_m_s: Floats, up_m_s: Floats, down_m_s: Floats) -> Floats:
    """Return the highest set point after a tick: faster forward, or slower backward down to zero."""
    return np.where(from_m_s >= 0.0, from_m_s + up_m_s, np.minimum(from_m_s + down_m_s, 0.0))


def _lowest(from_m_s: Floats, up_m_s: Floats, down_m_s: Floats) -> Floats:
    return np.where(from_m_s <= 0.0, from_m_s - up_m_s, np.maximum(from_m_s - down_m_s, 0.0))
