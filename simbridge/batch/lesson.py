"""Robot of a lesson in a batch, and its simulation: it drives compiled stretches, which can be taken back."""

import numpy as np

from hal.kurt2_settings import Kurt2Settings
from simbridge.batch.batch import RobotBatch
from simbridge.batch.compiled import with_types_of
from simbridge.batch.record import STRETCH
from simbridge.batch.safety import forget_all_contradictions
from simbridge.batch.tables import build_features, padded_width, require_features
from simbridge.batch.teach import Learner, Table, perceive, sense, teach
from simbridge.contracts.areas import Borders
from simbridge.contracts.batch import STANDS, BatchRefusedError, DriveSettings, PolicyMind
from simbridge.contracts.batch_lesson import LessonDriveSettings, LessonLog, LessonMode, TaughtRlas
from simbridge.contracts.simulation import Pose, Poses
from simbridge.robot_simulation import Kurt2Simulation
from simbridge.simulated_robot import SimulatedKurt2

MOST_TICKS = STRETCH // 2
"""Most ticks after a `keep`: half of the random numbers that lie ahead are used up at most before more are drawn."""
_MOST_RLAS = 4096
_ALONE = np.array([0])
"""Indexes of the robots of the batch."""


class CompiledLesson(RobotBatch):
    """Robot that is taught: its state, its course and its RLAs in arrays."""

    def __init__(self, robot: Kurt2Settings, simulated: SimulatedKurt2, settings: LessonDriveSettings) -> None:
        """Copy the state of a simulated robot that has not driven yet, which follows this robot from then on.

        Raises BatchRefusedError for what the batch does not know.
        """
        drive = DriveSettings(
            actions=settings.actions, minimum_ticks=settings.minimum_ticks, behaviours=settings.behaviours
        )
        require_features(settings.features)
        super().__init__(robot, [simulated], [PolicyMind(settings.policy)], drive)
        self._simulated = simulated
        width, rows, sensors = len(settings.features.kinds), settings.ticks + 1, len(robot.infrared.sensors)
        self._minimum_ticks = settings.minimum_ticks
        self._values = width + len(settings.features.average_weights)
        self.log = LessonLog(
            features=np.zeros((rows, width), dtype=np.int16),
            sums=np.zeros((rows, width), dtype=np.int32),
            counts=np.zeros((rows, sensors), dtype=np.int16),
            poses=np.zeros((rows, 3)),
            causes=np.full(rows, -1, dtype=np.int8),
            actions=np.full(rows, -1, dtype=np.int8),
            behaviours=np.zeros(rows, dtype=np.int8),
            right=np.full(rows, -1, dtype=np.int8),
            rlas=np.zeros(rows, dtype=np.int32),
            slow=np.zeros(rows, dtype=np.bool_),
            sure=np.zeros(rows, dtype=np.bool_),
            turned=np.zeros(rows, dtype=np.bool_),
            touching=np.zeros(rows, dtype=np.bool_),
            collisions=np.zeros(rows, dtype=np.int32),
        )
        self._table = Table(
            rows=np.zeros(1, dtype=np.int64),
            numbers=np.zeros(_MOST_RLAS, dtype=np.int64),
            conditions=np.zeros((_MOST_RLAS, padded_width(settings.features))),
            radius=np.zeros(_MOST_RLAS),
            action=np.zeros(_MOST_RLAS, dtype=np.int64),
            features=build_features(settings.features),
            added=np.zeros(rows, dtype=np.int64),
            mind=0 if settings.choose is None else self._python_mind.address,
        )
        self._choose, self._ticks, self._until = settings.choose, self._robots["tick"], self._robots["until"]
        self._choices = np.full(rows, STANDS, dtype=np.int8)
        """Index of the action that Python chose in each tick."""
        self._chosen_to = 0
        """Tick up to which choices are valid, while ticks are driven a second time."""
        self._learner = Learner(np.zeros(width, dtype=np.int64), np.zeros(3, dtype=np.int64), np.zeros(1))
        self._robots["held"], self._robots["speed_share"] = -1, 1.0
        self._arrays = self._robots, self._world, self._laws, self._learner, self._table, self.log
        self._perceive, self._sense, self._teach = with_types_of((perceive, sense, teach), *self._arrays)
        self.tick = 0
        """Tick that the robot has completed."""
        self._kept = 0
        self._draw_noise(0, MOST_TICKS)
        self._state = np.asarray(self._robots).view(np.uint8)
        self._saved = self._state.copy()
        self._saved_learner = [array.copy() for array in self._learner]

    @property
    def trouble(self) -> str:
        """Return why the lesson belongs on the loop over the CAN bus; empty if it does not."""
        return self.reason_to_leave(0)

    @property
    def waits(self) -> bool:
        """Return whether the next tick has begun, and waits for the physics engine."""
        return bool(self._waits.item(0))

    def watch_borders(self, borders: Borders) -> None:
        """Stop `run` where the robot crosses a border. Raises BatchRefusedError for too many areas."""
        self.watch(0, borders)
        self._keep_state()

    def select_behaviour(self, behaviour: str) -> None:
        """Make a taught behaviour active from the next decision on."""
        self.select(0, behaviour)
        self._keep_state()

    def set_rlas(self, rlas: TaughtRlas) -> None:
        """Replace the RLAs; the next decision may change the action at once. Raises BatchRefusedError for too many."""
        table, count = self._table, len(rlas.numbers)
        if count > _MOST_RLAS:
            raise BatchRefusedError(f"{count} RLAs: a lesson in a batch has at most {_MOST_RLAS}", do="use the CAN bus")
        place = {name: index for index, name in enumerate(self.actions)}
        table.rows[0] = count
        if count:
            table.numbers[:count] = rlas.numbers
            table.conditions[:count, : self._values] = rlas.conditions
            table.radius[:count] = rlas.radii
            table.action[:count] = [place[name] for name in rlas.actions]
        self.allow_switch()

    def allow_switch(self) -> None:
        """Let the next decision take another action at once."""
        self._robots[0]["action_ticks"] = self._minimum_ticks
        self._keep_state()

    def set_mode(self, mode: LessonMode) -> None:
        """Set the orders from the next decision on."""
        record, held = self._robots[0], self.actions.index(mode.held) if mode.held else -1
        if record["held"] >= 0 > held:
            record["action"] = record["rla"] = -1
        record["stopped"], record["held"], record["speed_share"] = mode.stopped, held, mode.speed_share
        self._keep_state()

    def restart_held(self) -> None:
        """Begin the held action from its start."""
        self._robots[0]["turned_m"] = 0.0
        self._keep_state()

    def trust_sensors(self) -> None:
        """Forget contradictions of sensors with their neighbours, as a resume does."""
        forget_all_contradictions(self._robots[0])
        self._keep_state()

    def sense(self) -> None:
        """Begin the next tick up to its situation; only after `keep`."""
        if not self.waits:
            self._sense(*self._arrays)
        if self.waits:
            self._move_in_engine(0)
            self._perceive(*self._arrays)
        self._keep_state()

    def run(self, until: int) -> int:
        """Drive to the end of a tick, and return the tick that was reached; less at a border, and before the engine.

        Raises ValueError for too many ticks since the last `keep`.
        """
        if not until - self._kept <= MOST_TICKS:
            raise ValueError(f"{until - self._kept} ticks to take back: keep after {MOST_TICKS}")
        assert not self.waits, "sense before the next stretch"
        self._until[0] = until
        self._teach(*self._arrays)
        self._python_mind.raise_error()
        self.tick = self._ticks.item(0) - bool(self._waits.item(0) or self._left.item(0))
        return self.tick

    def restore_tick(self, tick: int) -> None:
        """Restore the state at the end of an earlier tick, at most back to the last `keep`."""
        if tick == self.tick and not self.waits and not self._left.item(0):
            return
        self._state[:] = self._saved
        for array, saved in zip(self._learner, self._saved_learner, strict=True):
            array[:] = saved
        self._chosen_to = tick
        self.run(tick)
        self._chosen_to = 0

    def keep(self) -> Poses:
        """Keep all ticks so far, and return their poses; the simulation is where the robot is."""
        poses = Poses(self.log.poses[self._kept + 1 : self.tick + 1])
        if poses:
            self._simulated.follow(poses)
        self._keep_set_points(_ALONE)
        self._told_cm_s[0, 0] = self._told_cm_s[0, self._at.item(0)]  # of a tick that waits
        self._at[0] = self._caught_up[0] = 0
        self._draw_noise(0, MOST_TICKS)
        self._kept = self.tick
        self._keep_state()
        return poses

    def put_down(self, pose: Pose) -> None:
        """Put the robot, standing, at this pose; only after `keep`, and not while it waits for the engine."""
        self.put(0, pose)
        self._simulated.carry(pose)
        self._keep_state()

    def lesson_hash(self) -> str:
        """Return the state hash of the robot, as on the CAN bus."""
        return self.state_hash(0, self._simulated.laps)

    def _decide(self, r: int) -> int:
        """Return the index of the action that Python chooses in the present tick, or STANDS."""
        tick = self._ticks.item(r)
        if tick > self._chosen_to:
            assert self._choose is not None
            situation = self._situations[r, : self._values].copy()
            action = self._choose(self._behaviours[self._wanted.item(r)], situation)
            self._choices[tick] = STANDS if action is None else self.actions.index(action)
        return self._choices.item(tick)

    def _keep_state(self) -> None:
        self._saved[:] = self._state
        for array, saved in zip(self._learner, self._saved_learner, strict=True):
            saved[:] = array


class LessonSimulation(Kurt2Simulation):
    """Simulation whose robot drives in compiled stretches; bus and world stay behind, and its pose follows."""

    def __init__(
        self, settings: Kurt2Settings, world: str, seed: int, purpose: str, lesson: LessonDriveSettings
    ) -> None:
        """Open the simulation of `seed` and `purpose`. Raises BatchRefusedError for what the batch does not know."""
        super().__init__(settings, world, seed, purpose)
        self.lesson = CompiledLesson(settings, self.simulated_robot, lesson)

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        return int(self.lesson.log.collisions[self.lesson.tick])

    @property
    def touching(self) -> bool:
        """True while the robot touches something."""
        return bool(self.lesson.log.touching[self.lesson.tick])

    def put(self, pose: Pose) -> None:
        """Put the robot, standing, at this pose; only after `keep`."""
        self.lesson.put_down(pose)
