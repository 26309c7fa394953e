"""Options of the robot program beyond its settings, and its environment."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kurt2rt.service.bus_names import SIMULATED
from kurt2rt.service.open_robot import RobotOpener, open_robot
from kurt2rt.service.shutdown import ShutdownStage, force_exit
from kurt2rt.service.startup import RETRY_S


@dataclass(frozen=True, slots=True, kw_only=True)
class RunOptions:
    """Options of `kurt2rt run` that are not in the runtime settings."""

    bus: str = SIMULATED
    settings: str = "default"
    """Name or path of the runtime settings, for the child processes."""
    as_service: bool = False
    """True if a service manager started the program."""
    attended: bool = True
    """True if teachers come over the channel."""
    stopped: bool = False
    """True if the robot stands until its teacher says resume."""
    behaviour: str = ""
    """Behaviour at the start; empty: the first of the task."""
    page: bool = False
    phones: bool = False
    """True if the page is open to the network while a device is paired."""
    scripted_teacher: str | None = None
    """Name or path of the scripted teacher to start; None: none."""
    page_port: int | None = None
    """TCP port of the page; None: as the settings say."""
    can_log: Path | None = None
    """New file for all frames; None: frames are not logged."""
    record: bool = True
    """True if the run is recorded to the folder that the settings name."""
    unrecorded: str = ""
    """Reason that a run is not recorded although it should be, and what to do, in a line; empty without one."""
    live_view: tuple[str, int] | None = None
    """Host and port of the live view; None: no live view."""
    seconds: float | None = None
    """Length of the program's run in s; None: until a signal ends it."""
    seed: int = 1


@dataclass(frozen=True, slots=True)
class ProgramEnvironment:
    """Functions and times of the robot program that tests replace, such as the opener of the robot."""

    open_robot: RobotOpener = open_robot
    on_timeout: Callable[[ShutdownStage], None] | None = force_exit
    """Gets the stage of a program that does not end in time, as in `ShutdownHandler`."""
    retry_s: float = RETRY_S
    """Time between two attempts to find what is missing, in s."""
