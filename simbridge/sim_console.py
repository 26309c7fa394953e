"""Console of the simulated robot: status, events and commands."""

import contextlib
import math
import queue
import threading
from collections.abc import Callable, Iterator
from typing import TextIO

from simbridge.contracts.simulation import Pose
from simbridge.contracts.world_refusal import WorldRefusedError
from simbridge.realtime import RealtimeWorld, StandaloneRobot
from simbridge.worlds.world_settings import WorldSettings

HELP = """\
start N               put the robot down at a start pose of the world, 1, 2, ...
place X Y HEADING     put it down elsewhere: metres, degrees counter-clockwise from x
move NAME DX DY       shift a wall or an obstacle, in metres
lift, lower           put the robot on a block, wheels in the air, and down again
help                  this"""


class SimConsole:
    """Executor of the lines that a user types into `kurt2rt sim`."""

    def __init__(self, standalone: StandaloneRobot, world: WorldSettings, ground: RealtimeWorld) -> None:
        self._standalone = standalone
        self._starts = [each.pose for each in world.start_poses]
        self._ground = ground

    def obey(self, line: str) -> str:
        """Execute a typed line and return the answer for the screen; an error of the user is an answer, too."""
        match line.split():
            case []:
                return ""
            case ["help"]:
                return HELP
            case ["start", number] if number.isdecimal() and 1 <= int(number) <= len(self._starts):
                return self._put(self._starts[int(number) - 1])
            case ["start", *_]:
                return f"this world has the start poses 1 to {len(self._starts)}"
            case ["place", *numbers]:
                place = _numbers(numbers, 3)
                if place is None:
                    return "say where: place X Y HEADING, in metres and degrees"
                return self._put(Pose(place[0], place[1], math.radians(place[2])))
            case ["move", name, *numbers]:
                by = _numbers(numbers, 2)
                if by is None:
                    return "say by how much: move NAME DX DY, in metres"
                return _done(lambda: self._ground.move_wall(name, by[0], by[1]), f"{name} moved")
            case ["lift" | "lower" as word]:
                return self._lift(word == "lift")
            case _:
                return f"not understood: {line.strip()}\n{HELP}"

    def _lift(self, lifted: bool) -> str:
        def lift() -> None:
            self._standalone.robot.lifted = lifted

        self._standalone.simulation.submit(lift)
        return "the robot stands on a block, its wheels in the air" if lifted else "the robot stands on its wheels"

    def _put(self, pose: Pose) -> str:
        there = f"the robot stands at {pose.x_m:.2f} {pose.y_m:.2f} m, {math.degrees(pose.heading_rad):.0f} deg"
        return _done(lambda: self._ground.put_robot(*pose), there)


class TypedLines:
    """Lines typed at the console of `kurt2rt sim`, read by a thread so that the simulation never waits."""

    def __init__(self, lines: TextIO) -> None:
        self._lines = lines
        self._typed: queue.SimpleQueue[str] = queue.SimpleQueue()
        self.ended = False
        """True after the end of the input."""
        # Daemon: reading a terminal cannot be interrupted, and must not keep the process alive.
        self.thread = threading.Thread(target=self._read, name="keyboard", daemon=True)
        self.thread.start()

    def typed(self) -> Iterator[str]:
        """Yield the lines that were typed since the last call; never waits."""
        while not self._typed.empty():
            yield self._typed.get()

    def _read(self) -> None:
        # A program in the background may not read its terminal.
        with contextlib.suppress(OSError):
            for line in self._lines:
                self._typed.put(line)
        self.ended = True


class News:
    """Reporter of changes of the simulated robot, such as collisions or a lost link, for `kurt2rt sim`."""

    def __init__(self, standalone: StandaloneRobot) -> None:
        self._standalone = standalone
        self._unheard, self._dead, self._trouble, self._collisions = True, False, "", 0

    def since(self) -> Iterator[str]:
        """Yield a line for each change of the robot since the last call."""
        robot, trouble = self._standalone.robot, self._standalone.end.error_text
        controller = robot.controller
        unheard, dead, collisions = controller.watchdog_expired, controller.crashed, robot.collisions
        if trouble != self._trouble:
            yield f"lost: {trouble}" if trouble else "the bus is there again"
        if unheard != self._unheard:
            yield "CONTROL has ceased: the watchdog brakes" if unheard else "CONTROL is heard and obeyed"
        if dead != self._dead:
            yield (
                "a set point jumped: the controller crashed, MC_RESET revives it" if dead else "the controller is alive"
            )
        if collisions > self._collisions:
            yield f"collision {collisions} at {_place(robot.pose)}"
        self._unheard, self._dead, self._trouble, self._collisions = unheard, dead, trouble, collisions


class StatusLine:
    """Line on the simulated robot's time, place, speeds and frames for the console of `kurt2rt sim`."""

    def __init__(self, standalone: StandaloneRobot) -> None:
        self._standalone = standalone
        self._told_at_s = 0.0
        self._told = 0

    def next(self) -> str:
        """Return the present status in a line; its rates are those since the last call."""
        robot, end, simulation = self._standalone.robot, self._standalone.end, self._standalone.simulation
        controller = robot.controller
        time_s, control_frames = robot.time_s, controller.control_frames
        rate = (control_frames - self._told) / max(time_s - self._told_at_s, 0.01)
        self._told_at_s, self._told = time_s, control_frames
        turn, orders = robot.wheel_speeds, controller.commands
        braked = " with brakes" if orders.left_brake or orders.right_brake else ""
        parts = [
            f"{time_s:8.1f} s",
            f"at {_place(robot.pose)}",
            f"wheels {turn.left_m_s:+.2f} {turn.right_m_s:+.2f} m/s, "
            f"ordered {orders.left_m_s:+.2f} {orders.right_m_s:+.2f}{braked}",
            f"CONTROL {rate:.0f} a second, junk {controller.junk_frames}",
            f"collisions {robot.collisions}",
            f"missed {simulation.missed_cycles}",
        ]
        if controller.crashed:
            parts.append("crashed, needs MC_RESET")
        elif controller.watchdog_expired:
            parts.append("no CONTROL, braked")
        if robot.lifted:
            parts.append("on a block")
        if end.error_text:
            parts.append(f"{end.error_text}; {end.lost} frames lost")
        return " | ".join(parts)


def _place(pose: Pose) -> str:
    heading_deg = math.degrees(math.remainder(pose.heading_rad, math.tau))
    return f"{pose.x_m:.2f} {pose.y_m:.2f} m, {heading_deg:.0f} deg"


def _numbers(words: list[str], count: int) -> list[float] | None:
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        return None
    return numbers if len(numbers) == count and all(map(math.isfinite, numbers)) else None


def _done(do: Callable[[], None], said: str) -> str:
    try:
        do()
    except WorldRefusedError as error:
        return str(error)
    return said
