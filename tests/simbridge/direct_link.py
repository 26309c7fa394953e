"""Link that hands reports and set points over as objects: the least that a plug-in has to bring for a simulation."""

from collections.abc import Sequence

from hal.robot import WheelSpeeds
from hal.robot_link import BumperReport, RangeReport, Report, WheelReport
from hal.robot_settings import RobotSettings
from simbridge.controller.controller import MOTORS_BRAKED, MotorCommands
from simbridge.links import InstantLink
from simbridge.robot.body import Body
from simbridge.robot.wheels import Wheels


class DirectController:
    """Robot's end (simbridge.controller.controller.Controller)."""

    watchdog_expired = crashed = False
    control_frames = junk_frames = 0

    def __init__(self, cycle_s: float) -> None:
        self.commands = MOTORS_BRAKED
        self.counts: tuple[int, ...] = ()
        self.cycles: list[tuple[int, int, int]] = []
        """Ticks and bumpers of the cycles that the runtime has not received."""
        self.cycle_s = cycle_s

    @property
    def state(self) -> tuple[int, ...]:
        return (len(self.cycles),)

    def receive(self) -> None:
        pass

    def update_readings(self, fresh: Sequence[int], counts: Sequence[int]) -> None:  # noqa: ARG002
        self.counts = tuple(counts)

    def send(self, left_ticks: int, right_ticks: int, bumpers: int) -> None:
        self.cycles.append((left_ticks, right_ticks, bumpers))

    def power_cycle(self) -> None:
        self.commands = MOTORS_BRAKED


class DirectEnd:
    """Runtime's end (hal.robot_link.RobotLink)."""

    name, remedy = "direct link", "nothing"
    junk = unconfirmed = 0

    def __init__(self, controller: DirectController) -> None:
        self._controller = controller
        self.closed = False

    def receive(self, now_s: float) -> Sequence[Report]:
        controller = self._controller
        turned, controller.cycles = controller.cycles, []
        reports: list[Report] = [RangeReport(now_s, 0, controller.counts)] if turned else []
        for left, right, pressed in turned:
            reports += [WheelReport(now_s, left, right, controller.cycle_s), BumperReport(now_s, pressed)]
        return reports

    def applied(self, speeds: WheelSpeeds) -> WheelSpeeds:
        return speeds

    def send(self, speeds: WheelSpeeds) -> None:
        self._controller.commands = MotorCommands(*speeds)

    def brake(self) -> None:
        self._controller.commands = MOTORS_BRAKED

    def forget_unconfirmed(self) -> None:
        pass

    def reopen(self) -> None:
        pass

    def close(self) -> None:
        self.closed = True


class DirectLink(InstantLink):
    """Both ends (simbridge.simulation.PairedLink)."""

    def __init__(self, settings: RobotSettings) -> None:
        self._controller = DirectController(settings.cycle_s)
        self.runtime_end = DirectEnd(self._controller)

    def make_controller(self, body: Body, wheels: Wheels) -> DirectController:  # noqa: ARG002
        return self._controller
