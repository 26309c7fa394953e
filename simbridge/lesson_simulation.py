"""Simulation of a robot that is taught in a batch (simbridge.contracts.batch_lesson.TaughtSimulation)."""

from hal.kurt2_settings import Kurt2Settings
from simbridge.batch.lesson import CompiledLesson
from simbridge.contracts.batch_lesson import LessonDriveSettings
from simbridge.contracts.simulation import Pose
from simbridge.kurt2_simulation import Kurt2Simulation


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
