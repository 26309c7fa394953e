"""Simulation of a robot that is taught in a batch (simbridge.contracts.batch_lesson.LessonRobot)."""

from hal.kurt2_settings import Kurt2Settings
from simbridge.batch.lesson import CompiledLesson
from simbridge.contracts.areas import Borders
from simbridge.contracts.batch_lesson import LessonDriveSettings, LessonLog, LessonMode, TaughtRlas
from simbridge.contracts.simulation import Pose
from simbridge.kurt2_simulation import Kurt2Simulation


class LessonSimulation(Kurt2Simulation):
    """Simulation whose robot drives in compiled stretches; bus and world stay behind, and its pose follows."""

    def __init__(
        self, settings: Kurt2Settings, world: str, seed: int, purpose: str, lesson: LessonDriveSettings
    ) -> None:
        """Open the simulation of `seed` and `purpose`. Raises BatchRefusedError for what the batch does not know."""
        super().__init__(settings, world, seed, purpose)
        self._lesson = CompiledLesson(settings, self.simulated_robot, lesson)

    @property
    def actions(self) -> tuple[str, ...]:
        """Names of the actions, by index."""
        return self._lesson.actions

    @property
    def log(self) -> LessonLog:
        """Log of the lesson so far."""
        return self._lesson.log

    @property
    def reason_to_leave(self) -> str:
        """Return why the lesson belongs on the loop over the CAN bus; empty if it does not."""
        return self._lesson.reason_to_leave(0)

    def watch(self, borders: Borders) -> None:
        """Stop `drive` where the robot crosses a border. Raises BatchRefusedError for too many areas."""
        self._lesson.watch_borders(borders)

    def select(self, behaviour: str) -> None:
        """Make a taught behaviour active from the next decision on."""
        self._lesson.select_behaviour(behaviour)

    def set_rlas(self, rlas: TaughtRlas) -> None:
        """Replace the RLAs; the next decision may change the action at once. Raises BatchRefusedError for too many."""
        self._lesson.set_rlas(rlas)

    def set_mode(self, mode: LessonMode) -> None:
        """Set the orders from the next decision on."""
        self._lesson.set_mode(mode)

    def sense(self) -> None:
        """Begin the next tick up to its situation."""
        self._lesson.sense()

    def drive(self, until: int) -> int:
        """Drive to the end of a tick and return the tick that was reached. Raises ValueError for too many ticks."""
        return self._lesson.run(until)

    def restore_tick(self, tick: int) -> None:
        """Restore the state at the end of an earlier tick, at most back to the last `keep`."""
        self._lesson.restore_tick(tick)

    def keep(self) -> list[Pose]:
        """Keep all ticks so far, and return their poses."""
        return self._lesson.keep()

    @property
    def waits(self) -> bool:
        """Return whether the next tick has begun, and waits for the physics engine in `sense`."""
        return self._lesson.waits

    def allow_switch(self) -> None:
        """Let the next decision take another action at once."""
        self._lesson.allow_switch()

    def restart_held(self) -> None:
        """Begin the held action from its start."""
        self._lesson.restart_held()

    def trust_sensors(self) -> None:
        """Forget contradictions of sensors with their neighbours, as a resume does."""
        self._lesson.trust_sensors()

    def state_hash(self) -> str:
        """Return the state hash of the robot, as on the CAN bus."""
        return self._lesson.state_hash(0, self.laps)

    @property
    def collisions(self) -> int:
        """Contacts with walls or obstacles so far."""
        return int(self.log.collisions[self._lesson.tick])

    @property
    def touching(self) -> bool:
        """True while the robot touches something."""
        return bool(self.log.touching[self._lesson.tick])

    def put(self, pose: Pose) -> None:
        """Put the robot, standing, at this pose; only after `keep`."""
        self._lesson.put_down(pose)
