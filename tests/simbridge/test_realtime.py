import functools
import threading

import pytest

from hal.bus import BusError
from simbridge.realtime import RealtimeSimulation
from tests.simbridge.rig import Rig


class Steps:
    """Counts the steps of a simulation and tells when enough were made."""

    def __init__(self, rig: Rig, wanted: int) -> None:
        self.made = 0
        self.enough = threading.Event()
        self._step = rig.robot.step
        self._wanted = wanted

    def __call__(self) -> None:
        self._step()
        self.made += 1
        if self.made >= self._wanted:
            self.enough.set()


def test_it_steps_by_itself_and_stops(monkeypatch: pytest.MonkeyPatch) -> None:
    with Rig() as rig:
        steps = Steps(rig, 5)
        monkeypatch.setattr(rig.robot, "step", steps)
        with RealtimeSimulation(rig.robot) as simulation:
            assert steps.enough.wait(30.0)
        made = steps.made
        assert rig.robot.time_s == pytest.approx(made * 0.01)
        assert simulation.error is None
        rig.listen()
        assert rig.heard["ENCODER"] == (0, 0)


def test_an_error_in_the_thread_shows_and_comes_out_of_stop() -> None:
    with Rig() as rig:
        simulation = RealtimeSimulation(rig.robot)
        rig.robot_end.shutdown()
        simulation.start()
        simulation.wait(30.0)
        assert isinstance(simulation.error, BusError)
        with pytest.raises(BusError, match="is shut down"):
            simulation.stop()


def test_stopping_what_never_started_is_fine() -> None:
    with Rig() as rig:
        RealtimeSimulation(rig.robot).stop()


def test_missed_cycles_are_skipped_whole_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    with Rig() as rig:
        steps = Steps(rig, 3)
        monkeypatch.setattr(rig.robot, "step", steps)
        simulation = RealtimeSimulation(rig.robot, cycle_s=1e-6)  # no processor keeps this pace
        simulation.start()
        assert steps.enough.wait(30.0)
        simulation.stop()
        assert simulation.missed_cycles > 0


def test_an_error_in_the_thread_does_not_hide_what_the_body_raised() -> None:
    def fail_when_it_has_failed(simulation: RealtimeSimulation) -> None:
        with simulation:
            assert simulation.wait(30.0)
            raise ValueError("the body's own")

    with Rig() as rig:
        rig.robot_end.shutdown()
        with pytest.raises(ValueError, match="the body's own"):
            fail_when_it_has_failed(RealtimeSimulation(rig.robot))


def test_an_error_in_the_thread_comes_out_of_a_body_that_went_well() -> None:
    with Rig() as rig:
        rig.robot_end.shutdown()
        with pytest.raises(BusError, match="is shut down"), RealtimeSimulation(rig.robot) as simulation:
            assert simulation.wait(30.0)


def test_what_is_asked_is_done_in_order_by_the_thread_that_steps_before_its_next_step() -> None:
    with Rig() as rig:
        simulation = RealtimeSimulation(rig.robot)
        done: list[tuple[str, str, float]] = []
        finished = threading.Event()

        def job(name: str) -> None:
            done.append((name, threading.current_thread().name, rig.robot.time_s))

        for name in ("first", "second"):
            simulation.submit(functools.partial(job, name))
        simulation.submit(finished.set)
        with simulation:
            assert finished.wait(30.0)
        assert done == [("first", "simulated-robot", 0.0), ("second", "simulated-robot", 0.0)]


def test_what_is_asked_of_a_running_simulation_is_done_once_and_it_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    with Rig() as rig:
        steps = Steps(rig, 3)
        times: list[float] = []
        with RealtimeSimulation(rig.robot) as simulation:
            done = threading.Event()
            simulation.submit(lambda: times.append(rig.robot.time_s))
            simulation.submit(done.set)
            assert done.wait(30.0)
            monkeypatch.setattr(rig.robot, "step", steps)
            assert steps.enough.wait(30.0)
        assert len(times) == 1


def test_an_error_in_what_is_asked_ends_the_thread_and_comes_out_of_stop() -> None:
    def fail() -> None:
        raise ValueError("a wall that is none")

    with Rig() as rig:
        simulation = RealtimeSimulation(rig.robot)
        simulation.submit(fail)
        simulation.start()
        assert simulation.wait(30.0)
        with pytest.raises(ValueError, match="a wall that is none"):
            simulation.stop()
        assert rig.robot.time_s == 0.0


def test_while_it_is_held_only_its_holder_steps_it_and_what_is_asked_is_done(monkeypatch: pytest.MonkeyPatch) -> None:
    with Rig() as rig:
        by_whom: list[threading.Thread] = []
        again = threading.Event()

        def step() -> None:
            by_whom.append(threading.current_thread())
            if len(by_whom) > 3:
                again.set()

        monkeypatch.setattr(rig.robot, "step", step)
        with RealtimeSimulation(rig.robot, cycle_s=1e-6) as simulation:
            simulation.hold()
            by_whom.clear()
            asked: list[int] = []
            simulation.submit(lambda: asked.append(len(by_whom)))
            for _ in range(3):
                simulation.step()
            assert by_whom == [threading.current_thread()] * 3
            assert asked == [0]
            simulation.go_on()
            assert again.wait(30.0)
        assert threading.current_thread() not in by_whom[3:]
