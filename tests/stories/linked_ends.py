"""Ends of the links of robots without CAN, a serial line and topics of ROS 2, and the faults between them."""

import random
from abc import abstractmethod
from binascii import crc_hqx
from collections.abc import Callable, Iterable, Sequence
from functools import partial

from hal.bus import BusError
from hal.guarded_robot import GuardedRobot
from hal.linked_robot import LinkedRobot
from hal.robot_settings import RobotSettings
from kurt2rt.robots.school.lines import NUMBERS
from kurt2rt.robots.school.link import SchoolLink
from kurt2rt.robots.school.simulated import SchoolElectronics
from kurt2rt.robots.turtlebot.lidar import lidar_of
from kurt2rt.robots.turtlebot.link import TurtlebotLink
from kurt2rt.robots.turtlebot.settings import TurtlebotSettings
from kurt2rt.robots.turtlebot.simulated import TurtlebotElectronics
from kurt2rt.ros.messages import DiagnosticArray, DiagnosticStatus, Header, encode, to_time
from kurt2rt.ros.port import LocalTopics
from kurt2rt.ros.twist import PlaneTwist, Twists
from simbridge.robot.wheels import Wheels
from simbridge.simulated_robot import SimulatedRobot
from simbridge.worlds.world_settings import WorldSettings
from tests.stories import wire
from tests.stories.ends import Ends
from tests.stories.fault import FaultInjection
from tests.stories.poor_link import SHARE, PoorLink
from tests.stories.table import Fault

Deliver = Callable[[bytes], None]

_MOST_GARBAGE = 60
_LONGER_THAN_ODOMETRY = 1000
_WALL_S = 1e9
"""Wall clock at the beginning of simulated time; a stamp of 0 would mean none."""


class LinkedEnds(Ends):
    """Base of both. What the driver sends is neither doubled nor reordered."""

    speaks_every_s = 0.05

    def __init__(self, injection: FaultInjection, chance: random.Random) -> None:
        super().__init__(injection, chance)
        self._in = PoorLink(injection, self.target, chance, self._instead, jitters=True)
        self._out = PoorLink(injection, self.target, chance, self._instead, jitters=True)
        self._made_s = 0.0
        """Time at which the newest readings were made that arrived at the notebook."""

    def _command(self, payload: bytes, deliver: Deliver) -> None:
        """Carry a command of the driver."""
        number, fault = self._note_sent(payload), self._injection.of(self.target)

        def arrive(each: bytes) -> None:
            self.on_arrived(number, each, self._time.now_s())
            deliver(each)

        if fault is not None and fault.kind in ("doubled", "reordered"):
            arrive(payload)
        else:
            self._out.carry(payload, arrive)

    def _report(self, topic: str, payload: bytes, deliver: Deliver) -> None:
        """Carry a report of the robot."""
        made_s = self._time.now_s()

        def arrive(each: bytes) -> None:
            if self._has_ranges(each):
                self._made_s = max(self._made_s, made_s)
                self.on_heard(0, each, self._made_s)
            deliver(each)

        self._in.carry(payload, arrive, topic)

    def _instead(self, fault: Fault, message: bytes, newest: bytes) -> Iterable[bytes]:
        match fault.kind:
            case "garbage" if self._chance.random() < SHARE:
                return [self._garbled(message)]
            case "crlf":
                return [message[:-1] + b"\r\n"]
            case "stuck" if self._has_ranges(message) and self._has_ranges(newest):
                return [self._repeated(newest, message)]
        return [message]

    @abstractmethod
    def _garbled(self, message: bytes) -> bytes:
        """Return what arrives in place of a message."""

    @abstractmethod
    def _repeated(self, old: bytes, message: bytes) -> bytes:
        """Return a message with the readings of an old one of the range sensors."""

    @abstractmethod
    def _has_ranges(self, message: bytes) -> bool:
        """Return whether a message holds readings of the range sensors."""


class _Port:
    """End of a serial line (hal.byte_port.BytePort)."""

    name = "line of a story"

    def __init__(self, write: Deliver, check: Callable[[], None], late: Sequence[bytes] = ()) -> None:
        """`check`: raises BusError while the line is lost. `late`: what was written and has not left."""
        self._arrived, self._write, self._check, self._late = b"", write, check, late

    @property
    def waiting(self) -> int:
        return sum(map(len, self._late))

    def arrive(self, data: bytes) -> None:
        self._arrived += data

    def read(self) -> bytes:
        self._check()
        arrived, self._arrived = self._arrived, b""
        return arrived

    def write(self, data: bytes) -> None:
        self._write(data)  # it is judged, and lost if the line is
        self._check()

    def reopen(self) -> None:
        self._check()
        self._arrived = b""

    def close(self) -> None:
        """Do nothing: the line is in memory."""


class SerialEnds(LinkedEnds):
    """Ends of the serial line of a school robot."""

    target = "serial"
    wire = wire.SCHOOL

    def __init__(self, settings: RobotSettings, injection: FaultInjection, chance: random.Random) -> None:
        super().__init__(injection, chance)
        self._settings = settings
        self._robots_port = _Port(lambda line: self._report("line", line, self._drivers_port.arrive), lambda: None)
        self._drivers_port = _Port(self._send, self._check, self._out.late)

    def simulated(self, world: WorldSettings, seed: int, wheels: Wheels) -> SimulatedRobot:
        electronics = SchoolElectronics(self._settings, self._robots_port)
        return SimulatedRobot(self._settings, world, lambda *_: electronics, seed, wheels=wheels)

    def start_driver(self) -> GuardedRobot:
        self._drivers_port = _Port(self._send, self._check, self._out.late)
        sensors, first = len(self._settings.infrared.sensors), self._chance.randrange(NUMBERS)
        return LinkedRobot(self._settings, SchoolLink(self._drivers_port, sensors, first), self._time.now_s)

    def _check(self) -> None:
        if self.back_at_s:
            raise BusError("the adapter is gone", where=_Port.name, do="plug it in")

    def _send(self, line: bytes) -> None:
        if line.startswith(b"school "):
            self._out.carry(line, self._robots_port.arrive)
        else:
            self._command(line, self._robots_port.arrive)

    def _say(self, fault: Fault, *, over: bool) -> None:  # noqa: ARG002 - a stranger is silent then
        if not over:
            chance = self._chance
            speeds_mm_s = chance.randint(-100, 100), chance.randint(-100, 100)
            self._robots_port.arrive(_line(b"drive %d %d %d" % (chance.randrange(NUMBERS), *speeds_mm_s)))

    def _garbled(self, message: bytes) -> bytes:
        return self._chance.choice((message[: self._chance.randrange(len(message))], b"", message)) + (
            self._chance.randbytes(self._chance.randrange(_MOST_GARBAGE))
        )

    def _repeated(self, old: bytes, message: bytes) -> bytes:
        readings = wire.words_of(old)[6:]
        if {*readings} == {b"0"}:
            readings[-1] = b"1"
        return _line(b" ".join(wire.words_of(message)[:6] + readings))

    def _has_ranges(self, message: bytes) -> bool:
        return any(wire.words_of(line)[:1] == [b"sense"] for line in message.split(b"\n"))  # garbage may follow it


def _line(body: bytes) -> bytes:
    return b"%s*%04X\n" % (body, crc_hqx(body, 0))


class _Clock:
    """Clocks of one end (kurt2rt.ros.inbox.Clock); its wall clock may be set."""

    def __init__(self, now_s: Callable[[], float], step_s: Callable[[], float]) -> None:
        self.now_s, self._step_s = now_s, step_s

    def wall_s(self) -> float:
        return _WALL_S + self.now_s() + self._step_s()


class _Topics(LocalTopics):
    """Topics at one end of a network."""

    def __init__(self, settings: TurtlebotSettings, send: Callable[[str, bytes], None]) -> None:
        super().__init__(settings.ros)
        self._send = send

    def carry(self, key: str, payload: bytes, sender: object = None) -> None:
        """Send what this end's program publishes; deliver what comes from elsewhere."""
        if sender is None:
            super().carry(key, payload)
        else:
            self._send(key, payload)


class TopicEnds(LinkedEnds):
    """Ends of the topics of a base."""

    target = "topics"
    wire = wire.TURTLEBOT

    def __init__(self, settings: TurtlebotSettings, injection: FaultInjection, chance: random.Random) -> None:
        super().__init__(injection, chance)
        self._settings, self._step_s = settings, 0.0
        self._robots_clock = _Clock(self._time.now_s, lambda: self._step_s)
        self._drivers_clock = _Clock(self._time.now_s, injection.wall_clock_step_s)
        self._twists = Twists(settings.twist, settings)
        self._robots_topics = _Topics(settings, self._report_of)
        self._drivers_topics = _Topics(settings, self._send)

    def simulated(self, world: WorldSettings, seed: int, wheels: Wheels) -> SimulatedRobot:
        electronics = TurtlebotElectronics(self._settings, self._robots_topics.join(), self._robots_clock)
        return SimulatedRobot(self._settings, world, lambda *_: electronics, seed, wheels=wheels, make_sensors=lidar_of)

    def start_driver(self) -> GuardedRobot:
        self._drivers_topics = _Topics(self._settings, self._send)
        fault = self._injection.acting_on(self.target)
        self._drivers_topics.connected = fault is None or fault.kind != "off"
        link = TurtlebotLink(self._settings, self._drivers_topics.join(), "topics of a story", self._drivers_clock)
        return LinkedRobot(self._settings, link, self._time.now_s)

    def begin(self, fault: Fault) -> None:
        super().begin(fault)
        if fault.target == self.target:
            self._drivers_topics.connected = fault.kind != "off"
            self._step_s = self._chance.choice((-1, 1)) * fault.delay_s if fault.kind == "stamps" else 0.0

    def finish(self, fault: Fault) -> None:
        super().finish(fault)
        if fault.target == self.target:
            self._drivers_topics.connected, self._step_s = True, 0.0

    def _send(self, key: str, payload: bytes) -> None:
        self._command(payload, partial(self._robots_topics.carry, key))

    def _report_of(self, key: str, payload: bytes) -> None:
        self._report(key, payload, partial(self._drivers_topics.carry, key))

    def _say(self, fault: Fault, *, over: bool) -> None:
        ros, stamp_s = self._settings.ros, self._robots_clock.wall_s()
        if fault.kind == "alarm":
            level = DiagnosticStatus.OK if over else DiagnosticStatus.ERROR
            status = DiagnosticStatus(level, f"{ros.stops_on_errors_of[0]}_motor", "too hot", "", [])
            array = DiagnosticArray(Header(to_time(stamp_s), ""), [status])
            self._drivers_topics.carry(ros.diagnostics, encode(array))
        elif not over:
            speed_m_s, turn_rad_s = self._chance.uniform(-0.2, 0.2), self._chance.uniform(-1.0, 1.0)
            twist = encode(self._twists.message(PlaneTwist(speed_m_s, turn_rad_s), stamp_s))
            for topics in (self._robots_topics, self._drivers_topics):
                topics.carry(ros.cmd_vel, twist)

    def _garbled(self, message: bytes) -> bytes:
        chance = self._chance
        if self.wire.decode(message) is not None or chance.random() < 0.5:  # a twist that chance makes would be obeyed
            return chance.randbytes(chance.randrange(_MOST_GARBAGE))
        place = chance.randrange(len(message))
        return message[:place] + chance.randbytes(1) + message[place + 1 :]

    def _repeated(self, old: bytes, message: bytes) -> bytes:
        return message[:12] + old[12:]  # CDR's header and the stamp

    def _has_ranges(self, message: bytes) -> bool:
        return len(message) > _LONGER_THAN_ODOMETRY
