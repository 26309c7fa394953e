"""Library of the robot KURT2, taught by rule-like associations (RLAs).

These names are promised; all other modules may change without notice:

    SimulatedRobot  a robot in a simulated world: step it, read its senses, teach it, ask it why
    Teacher         connection to a robot that runs, real or simulated (`kurt2rt run`)
    teach           let a scripted teacher teach a task, and get the knowledge
    Knowledge       taught RLAs, in a file
    examine         let taught robots drive without a teacher
    Examination     result of `examine`, with a table and a plot
    replay          decide a recorded run again, and compare bit for bit
    ReplayedRun     result of `replay`, with decisions and a plot
    learner_setting setting that a learner of a task is made with
    Error           base of the errors that you can mend

A first plot:

    import kurt2rt

    with kurt2rt.SimulatedRobot(task="wall_following", world="a", seed=1) as robot:
        robot.teach("forward")
        robot.run(seconds=5)
        print(robot.senses["front"].metres, robot.why())
        robot.plot().savefig("drive.png")

Let a scripted teacher teach, and examine what was learned:

    taught = kurt2rt.teach("walls.knowledge", task="wall_following", seed=1)
    print(kurt2rt.examine(taught, worlds=["b"], seeds=[1, 2]))

Record a run, and decide it again:

    with kurt2rt.SimulatedRobot(knowledge=taught, record="recordings") as robot:
        robot.run(seconds=20)
    print(kurt2rt.replay("recordings").exact, robot.why(at=7.5))

Test your own code with pytest, whose fixtures kurt2, taught_robot and kurt2_on_vcan come with this package:

    def test_my_code(kurt2):
        my_code(kurt2)
        assert kurt2.collisions == 0
"""

from importlib import import_module
from typing import TYPE_CHECKING

from kurt2rt.platform.own_packages import hidden_packages

if TYPE_CHECKING:
    from config.errors import UserError as Error
    from kurt2rt.library.examination import Examination, examine
    from kurt2rt.library.knowledge import Knowledge, teach
    from kurt2rt.library.learners import learner_setting
    from kurt2rt.library.replay import ReplayedRun, replay
    from kurt2rt.library.simulated_robot import SimulatedRobot
    from kurt2rt.teacher.client.teacher import Teacher

    __version__: str

__all__ = [
    "Error",
    "Examination",
    "Knowledge",
    "ReplayedRun",
    "SimulatedRobot",
    "Teacher",
    "__version__",
    "examine",
    "learner_setting",
    "replay",
    "teach",
]

_PLACES = {
    "Error": ("config.errors", "UserError"),
    "Examination": ("kurt2rt.library.examination", "Examination"),
    "Knowledge": ("kurt2rt.library.knowledge", "Knowledge"),
    "ReplayedRun": ("kurt2rt.library.replay", "ReplayedRun"),
    "SimulatedRobot": ("kurt2rt.library.simulated_robot", "SimulatedRobot"),
    "Teacher": ("kurt2rt.teacher.client.teacher", "Teacher"),
    "examine": ("kurt2rt.library.examination", "examine"),
    "learner_setting": ("kurt2rt.library.learners", "learner_setting"),
    "replay": ("kurt2rt.library.replay", "replay"),
    "teach": ("kurt2rt.library.knowledge", "teach"),
}
"""Module and name there of each promised name, imported on first use (PEP 562)."""


if not TYPE_CHECKING:  # a type checker would take any name for promised

    def __getattr__(name: str) -> object:
        """Import a promised name on its first use.

        Raises AttributeError for any other name, ImportError if a foreign package hides one of the program's.
        """
        if name == "__version__":
            # Not at the top: this module takes longer to import than all others here.
            from importlib.metadata import version

            return version("kurt2rt")
        if name not in _PLACES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}; allowed are {', '.join(__all__)}")
        if hidden := hidden_packages():
            raise ImportError(hidden)
        module, there = _PLACES[name]
        found: object = getattr(import_module(module), there)
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    """Return the promised names."""
    return sorted(__all__)
