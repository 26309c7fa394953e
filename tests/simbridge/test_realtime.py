"""Real-time thread of the simulation."""

import threading

import pytest

from hal.bus import BusError
from simbridge.realtime import RealtimeSimulation
from tests.patience import PATIENCE_S
from tests.simbridge.rig import Rig


class StepCounter:
    """Replacement of a robot's step that records the stepping threads and signals the n-th step.

    It reads the frames of each step: a main thread that waits for a processor would let them fill the bus.
    """

    def __init__(self, rig: Rig, monkeypatch: pytest.MonkeyPatch, wanted: int) -> None:
        self.threads: list[threading.Thread] = []
        self.enough = threading.Event()
        self._rig, self._step, self._wanted = rig, rig.robot.step, wanted
        monkeypatch.setattr(rig.robot, "step", self)

    def __call__(self) -> None:
        self._step()
        self._rig.listen()
        self.threads.append(threading.current_thread())
        if len(self.threads) >= self._wanted:
            self.enough.set()


def fail() -> None:
    raise ValueError("from a job")


def test_thread_steps_and_stops(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    steps = StepCounter(rig, monkeypatch, 5)
    with RealtimeSimulation(rig.robot) as simulation:
        assert steps.enough.wait(PATIENCE_S)
    assert rig.robot.time_s == pytest.approx(len(steps.threads) * 0.01)
    assert simulation.error is None
    assert rig.heard["ENCODER"] == (0, 0)


def test_thread_error_is_raised_by_stop(rig: Rig) -> None:
    simulation = RealtimeSimulation(rig.robot)
    rig.robot_end.shutdown()
    simulation.start()
    simulation.wait(PATIENCE_S)
    assert isinstance(simulation.error, BusError)
    with pytest.raises(BusError):
        simulation.stop()


def test_stop_without_start_returns(rig: Rig) -> None:
    RealtimeSimulation(rig.robot).stop()


@pytest.mark.parametrize("body_error", [None, ValueError("from the body")])
def test_context_raises_the_bodys_error_first(body_error: ValueError | None, rig: Rig) -> None:
    def run() -> None:
        with RealtimeSimulation(rig.robot) as simulation:
            assert simulation.wait(PATIENCE_S)
            if body_error is not None:
                raise body_error

    rig.robot_end.shutdown()
    with pytest.raises(BusError if body_error is None else ValueError):
        run()


def test_submit_failing_job_ends_the_thread(rig: Rig) -> None:
    simulation = RealtimeSimulation(rig.robot)
    simulation.submit(fail)
    simulation.start()
    assert simulation.wait(PATIENCE_S)
    with pytest.raises(ValueError, match="from a job"):
        simulation.stop()
    assert rig.robot.time_s == 0.0


def test_hold_leaves_steps_and_jobs_to_the_caller(monkeypatch: pytest.MonkeyPatch, rig: Rig) -> None:
    steps = StepCounter(rig, monkeypatch, 4)
    jobs: list[int] = []
    with RealtimeSimulation(rig.robot, cycle_s=1e-3) as simulation:
        simulation.hold()
        steps.threads.clear()
        steps.enough.clear()
        simulation.submit(lambda: jobs.append(len(steps.threads)))
        for _ in range(3):
            simulation.step()
        assert steps.threads == [threading.current_thread()] * 3
        assert jobs == [0]
        simulation.go_on()
        assert steps.enough.wait(PATIENCE_S)
    assert threading.current_thread() not in steps.threads[3:]
