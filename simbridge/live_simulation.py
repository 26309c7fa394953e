"""Simulation in real time, for a program that drives the robot it simulates."""

from collections.abc import Iterator
from contextlib import contextmanager

from hal.guard_reason import GuardReason
from hal.guarded_robot import GuardedRobot
from hal.simulation import LiveSimulation
from simbridge.robot_simulation import RobotSimulation
from simbridge.simulated_world import RealtimeWorld
from simbridge.worlds.world_settings import WorldSettings


@contextmanager
def run_live(simulation: RobotSimulation, driver: GuardedRobot, world: WorldSettings) -> Iterator[LiveSimulation]:
    """Run a simulation in real time, its watchdog running, with its world for a teacher; close it at the end.

    `driver`: of the simulation, tolerant of stalls. `world`: in which it drives. Leaving raises the error that ended
    the simulation.
    """
    try:
        with simulation.live() as thread:
            ground = RealtimeWorld(simulation.simulated_robot, world, simulation.settings.geometry, thread)
            yield LiveSimulation(simulation, driver, ground)
            # While the simulation still runs, so that the last frame finds a listener.
            driver.emergency_stop(GuardReason.RUN_OVER)
    finally:
        simulation.close()
