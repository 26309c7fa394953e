"""Batch of simulated robots (of contracts): their state is copied from fresh simulations on the CAN bus."""

import copy
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from hal.guard_limits import REASONS
from hal.kurt2_settings import Kurt2Settings
from simbridge.batch.asking import PythonMind
from simbridge.batch.borders import area_of
from simbridge.batch.compiled import with_types_of
from simbridge.batch.contacts import ContactBody, SetPoints
from simbridge.batch.drive import drive, put_down
from simbridge.batch.record import (
    BROKEN,
    CROWDED,
    FROZEN,
    MOST_AREAS,
    NOISE_AHEAD,
    SLIP_AHEAD,
    STAYS,
    STRETCH,
    UNDECIDED,
    restart_window,
)
from simbridge.batch.setup import build_laws, build_robots
from simbridge.batch.tables import ON_THE_BUS, build_knowledge, empty_averages, require_known
from simbridge.contracts.areas import Borders
from simbridge.contracts.batch import (
    STANDS,
    TRACED_TICKS,
    BatchRefusedError,
    CallbackMind,
    CommandedMind,
    DriveSettings,
    Mind,
    Stretch,
    Tally,
    Trace,
)
from simbridge.contracts.simulation import Pose, Poses
from simbridge.simulated_robot import SimulatedKurt2, hash_state

_REASONS = {
    STAYS: "",
    FROZEN: "a board of sensors repeats itself",
    BROKEN: "a sensor looks broken",
    CROWDED: "too many walls are near",
    UNDECIDED: "what decides in Python raised an error",
}


_MOVING = (
    *("x_m", "y_m", "heading_rad", "vx_m_s", "vy_m_s", "yaw_rad_s", "left_slip", "right_slip"),
    *("left_m_s", "right_m_s", "left_carry", "right_carry", "left_told_m_s", "right_told_m_s"),
)
"""Names of the numbers of a moving robot, in the order of its state hash."""


class RobotBatch:
    """Batch of KURT2s: compiled loops drive each as the CAN bus does, bit by bit, until it leaves."""

    def __init__(
        self,
        robot: Kurt2Settings,
        simulated: Sequence[SimulatedKurt2],
        minds: Sequence[Mind],
        settings: DriveSettings,
    ) -> None:
        """Copy the state of simulated robots that have not driven yet.

        Args:
            robot: settings of all robots.
            simulated: robots with their worlds.
            minds: what drives each robot.
            settings: actions, and their minimum time.

        Raises:
            BatchRefusedError: for what the batch does not know.
        """
        require_known(robot, simulated, minds, settings)
        self.actions, self._behaviours = tuple(settings.actions), settings.behaviours
        self._laws = build_laws(robot, simulated[0], minds, settings)
        self._minds = minds
        self._python_mind = PythonMind(self._decide)
        self._knowledge, tables = build_knowledge(minds, self.actions, self._python_mind.address)
        self._averages = empty_averages(len(simulated), self._knowledge.features)
        self._robots, self._world = build_robots(robot, simulated, minds, tables)
        self._first_rows = self._knowledge.first[tables]
        self._parts = self._robots, self._world, self._laws, self._knowledge, self._averages
        # Views, because an item of a record takes Python ten times as long.
        fields = ("situation", "behaviour", "at", "left", "waits", "moved", "track_told_cm_s")
        self._situations, self._wanted, self._at, self._left, self._waits, self._moved, self._told_cm_s = (
            np.asarray(self._robots[field]) for field in fields
        )
        # The bodies in the engine draw their slip themselves, when they catch up.
        self._streams = [(copy.deepcopy(each.slip_noise), each.infrared_noise) for each in simulated]
        self._bodies = [ContactBody(each) for each in simulated]
        self._set_points = SetPoints()
        """Those of the earlier stretches that each body in the engine lags behind."""
        self._caught_up = np.zeros(len(simulated), dtype=np.int64)
        """Ticks of the present stretch that it has driven."""
        self._drawn = [[slip.drawn - SLIP_AHEAD, noise.drawn - NOISE_AHEAD] for slip, noise in self._streams]
        """Numbers that each robot had drawn before those that lie ahead: of slip, of its sensors."""
        self._robots["slip_used"], self._robots["noise_used"] = SLIP_AHEAD, NOISE_AHEAD
        names = (("slip_noise", "slip_used"), ("noise", "noise_used"))
        self._ahead = [(np.asarray(self._robots[numbers]), np.asarray(self._robots[used])) for numbers, used in names]
        """Numbers that lie ahead of all robots, and how many are used of them: of slip, of the sensors."""
        self._longest = TRACED_TICKS if any(isinstance(mind, CommandedMind) for mind in minds) else STRETCH

    @cached_property
    def _drive(self) -> Callable[..., None]:
        return with_types_of([drive], np.zeros(0, dtype=np.int64), 0, *self._parts)[0]

    def drive(self, robots: Sequence[int], ticks: int) -> list[int]:
        """Let these robots drive so many ticks on, at most the longest stretch, and return those that can go on.

        Robots that leave the batch, are stuck or cross a border stop early. Raises ValueError for a longer stretch, and
        for a robot that cannot go on.
        """
        if not 0 < ticks <= self._longest:
            raise ValueError(f"a stretch of {ticks} ticks: give 1 to {self._longest}")
        if stopped := set(robots) - set(self._going_on(robots)):
            raise ValueError(f"robot {min(stopped)} has left the batch, or is stuck")
        for r in robots:
            self._draw_noise(r, ticks)
        chosen = np.array(robots, dtype=np.int64)
        self._robots["at"][chosen] = self._robots["crossed"][chosen] = self._caught_up[chosen] = 0
        active = chosen
        while len(active):
            self._drive(active, ticks, *self._parts)
            self._python_mind.raise_error()
            active = active[self._waits[active] != 0]
            for r in active.tolist():
                self._move_in_engine(r)
        self._keep_set_points(chosen)
        return self._going_on(robots)

    def _going_on(self, robots: Sequence[int]) -> list[int]:
        """Return those of the robots that neither left the batch nor are stuck."""
        ended = (self._robots["left"] != 0) | (self._robots["stuck"] != 0)
        return [r for r in robots if not ended[r]]

    def _move_in_engine(self, r: int) -> None:
        """Let the engine move the body of a robot that waits for it."""
        end = self._at.item(r) + 1
        behind = self._set_points.take(r, self._told_cm_s[r, self._caught_up[r] : end])
        self._moved[r] = self._bodies[r].move(self._robots[r], behind)
        self._caught_up[r] = end

    def _decide(self, r: int) -> int:
        """Return the index of the action that the mind of a robot chooses, or STANDS."""
        mind = self._minds[r]
        assert isinstance(mind, CallbackMind)
        width = len(mind.features.kinds) + len(mind.features.average_weights)
        action = mind.choose(self._behaviours[self._wanted.item(r)], self._situations[r, :width].copy())
        return STANDS if action is None else self.actions.index(action)

    def _keep_set_points(self, chosen: NDArray[np.int64]) -> None:
        """Keep the set points of the present stretch for the bodies in the engine that lag behind."""
        ends = self._at[chosen]
        told_cm_s = self._told_cm_s[chosen, : ends.max(initial=0)].astype(np.int16)
        self._set_points.add(chosen, told_cm_s, self._caught_up[chosen], ends)

    def reason_to_leave(self, robot: int) -> str:
        """Return why a robot cannot be driven in the batch any further; empty if it can."""
        return _REASONS[self._left.item(robot)]

    def stretch(self, robot: int) -> Stretch:
        """Return the course of a robot over the newest call of `drive`."""
        record = self._robots[robot]
        end = int(record["at"])
        columns = [record[f"track_{name}"][:end] for name in Pose._fields]
        rlas = record["track_rla"][:end]
        return Stretch(
            Poses(np.stack(columns, axis=1)),
            record["track_action"][:end].tolist(),
            np.where(rlas == STANDS, STANDS, rlas - self._first_rows[robot]).tolist(),
            record["track_distance"][:end].tolist(),
            record["track_collisions"][:end].tolist(),
            record["track_begins"][:end].tolist(),
        )

    def tally(self, robot: int) -> Tally:
        """Return the counts of a robot's drive so far."""
        record = self._robots[robot]
        return Tally(
            ticks=int(record["tick"]),
            unknown_ticks=int(record["unknown_ticks"]),
            questions=int(record["questions"]),
            first_question=int(record["first_question"]),
            collisions=int(record["collisions"]),
            first_collision=int(record["first_collision"]),
            stuck=bool(record["stuck"]),
            travelled_m=float(record["travelled_m"]),
        )

    def command(self, robot: int, action: int) -> None:
        """Let an action, by its index, drive a commanded robot from the next tick on; a finished turn begins again."""
        record = self._robots[robot]
        if record["action"] == action and record["turned_m"] >= self._laws.mind.wanted_m[action]:
            record["action"] = STANDS
        record["command"] = action

    def watch(self, robot: int, borders: Borders) -> None:
        """Stop stretches of a robot where it crosses a border. Raises BatchRefusedError for too many areas."""
        record, count = self._robots[robot], len(borders.areas)
        if count > MOST_AREAS:
            raise BatchRefusedError(f"a world has {count} areas (a batch knows {MOST_AREAS} at most)", do=ON_THE_BUS)
        record["areas"][:count] = borders.areas
        record["area_count"] = count
        record["area_every"], record["area_margin_m"] = borders.every_ticks, borders.margin_m
        record["area"] = area_of(record)

    def select(self, robot: int, behaviour: str) -> None:
        """Make a taught behaviour of a robot active; its next decision may change the action at once."""
        record, place = self._robots[robot], self._behaviours.index(behaviour)
        if record["behaviour"] != place:
            record["behaviour"], record["question_left"] = place, 0
            record["action_ticks"] = self._laws.mind.minimum_ticks

    def put(self, robot: int, pose: Pose) -> None:
        """Put a robot, standing, at this pose; it must not wait for the engine."""
        record, before = self._robots[robot], self._robots[robot : robot + 1].copy()[0]
        assert not record["waits"]
        self._draw_noise(robot, STRETCH)
        record["x_m"], record["y_m"], record["heading_rad"] = pose
        record["free_cycles"] = self._laws.body.gap_cycles + 1
        if not put_down(record, self._world, self._laws):
            self._bodies[robot].put(pose, before, self._set_points.take(robot, self._told_cm_s[robot, :0]))
            record["box_is_new"] = 0
        restart_window(record, self._laws.stuck)

    def trace(self, robot: int) -> Trace:
        """Return the readings of a commanded robot over the newest call of `drive`."""
        record = self._robots[robot]
        end = int(record["at"])
        names = ("left_ticks", "right_ticks", "bumpers", "limits")
        left_ticks, right_ticks, bumpers, limits = (record[f"track_{name}"][:end].tolist() for name in names)
        counts = list(map(tuple, record["track_counts"][:end].tolist()))
        return Trace(counts, left_ticks, right_ticks, bumpers, [REASONS[each] for each in limits])

    def state_hash(self, robot: int, laps: float) -> str:
        """Return the state hash of a robot, as the simulated robot on the CAN bus has it after these ticks.

        `laps`: its progress along walls, which the batch does not measure.
        """
        record = self._robots[robot]
        ticks = int(record["tick"])
        braked = float(ticks < 2)  # by the controller's watchdog, before the first CONTROL
        moving = [float(record[name]) for name in _MOVING]
        numbers = (*moving, braked, braked, *record["due_s"].tolist(), laps)
        slip, noise = self._drawn[robot]
        drawn = (noise + int(record["noise_used"]), slip + int(record["slip_used"]))
        met = (int(record["bumpers"]), int(record["collisions"]))
        return hash_state(numbers, (*record["counts"].tolist(), ticks, *met, *drawn, 0, 1, 0, 0))

    def _draw_noise(self, robot: int, ticks: int) -> None:
        """Draw random numbers, after those that are left, unless enough for so many ticks lie ahead."""
        drawn = self._drawn[robot]
        for place, (stream, (ahead, used_of)) in enumerate(zip(self._streams[robot], self._ahead, strict=True)):
            numbers, used = ahead[robot], int(used_of[robot])
            left = len(numbers) - used
            if left * STRETCH >= len(numbers) * ticks:
                continue
            numbers[:left] = numbers[used:]
            stream.fill(numbers[left:])
            used_of[robot] = 0
            drawn[place] += used
