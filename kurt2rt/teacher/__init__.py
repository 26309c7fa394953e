"""The teacher's side: commands, questions, lessons, a scripted teacher, and clients for a teacher's device.

`TeacherClient` is async, `Teacher` is for scripts and notebooks, `RobotProcess` is a simulated robot to teach.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kurt2rt.teacher.client.client import TeacherClient
    from kurt2rt.teacher.client.robot_process import RobotProcess
    from kurt2rt.teacher.client.teacher import Teacher

__all__ = ["RobotProcess", "Teacher", "TeacherClient"]

_MODULES = {"RobotProcess": "robot_process", "Teacher": "teacher", "TeacherClient": "client"}


def __getattr__(name: str) -> Any:
    # Imported at first use: the network library takes 0.2 s.
    if name in _MODULES:
        return getattr(import_module(f"kurt2rt.teacher.client.{_MODULES[name]}"), name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
