"""What robot this is, for a teacher's device that has never seen it."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from kurt2rt.channel.protocol.requests import BOOT_BYTES, LARGEST_NUMBER, VERSION
from kurt2rt.channel.protocol.schema import Bytes, Flag, Float, Int, ManyOf, OrNone, Row, Text, WireError
from kurt2rt.core.perception.sensor_words import InfraredLaw, SensorWords

_NAME = Text(64)
_METRES = Float(1000.0, "m")
_NUMBER = Int(0, LARGEST_NUMBER)
_BOOT = Bytes(BOOT_BYTES)
_SENSORS = ManyOf(Row((_NAME, _NAME, _METRES, _METRES, Float(360.0, "degrees"))), most=64)
_APPRAISALS = ManyOf(Row((_NAME, Int(-1, 1))), most=16)
_MID = OrNone(Row((_NAME, Int(0, 256), Float(1e9))))
_OUTLINE = Row((_METRES, _METRES))
_WHAT = Text(128)
_COUNTS = Float(1e6, "counts")
_LAW = OrNone(Row((_COUNTS, _METRES, _COUNTS, _METRES, _METRES, _COUNTS)))


class AppraisalName(NamedTuple):
    """What a teacher can call a situation when he teaches the critic, and the signal that it stands for."""

    name: str
    value: int
    """-1, 0 or +1."""


class MidIntroduction(NamedTuple):
    """The mid level, for who has never seen it."""

    kind: str
    """Of its situation: history, place."""
    length: int
    """How many features the situation has."""
    radius: float
    """R of its RLA system."""


class SensorPlace(NamedTuple):
    """Where an infra-red sensor sits and looks, in the robot's frame: x forward, y to the left."""

    name: str
    label: str
    x_m: float
    y_m: float
    heading_deg: float


@dataclass(frozen=True, slots=True)
class Hello:
    """The robot introduces itself."""

    version: int
    """Of the wire contract."""
    boot: bytes
    tick: int
    robot: str
    task: str
    radius: float
    """R of the RLA system."""
    period_s: float
    """Of a tick."""
    actions: tuple[str, ...]
    """The repertoire."""
    sensors: tuple[SensorPlace, ...]
    outline: tuple[float, float]
    """Length and width of the robot in metres."""
    max_m_s: float
    simulated: bool
    phases: tuple[str, ...]
    """Names of the training phases; the first one's number is 1."""
    behaviours: tuple[str, ...] = ("",)
    """What the task teaches, each with RLAs of its own; a single one may have no name."""
    appraisals: tuple[AppraisalName, ...] = ()
    """The critic's repertoire; empty where the robot has no critic."""
    trusted_from: float = 1.0
    """Agreement from which on the critic is trusted."""
    mid: MidIntroduction | None = None
    """None where no mid level chooses the behaviours."""
    seeks: bool = False
    """Whether the robot can be given a goal."""
    what: str = ""
    """The task in one sentence to its teacher; empty from a robot that does not tell it."""
    law: InfraredLaw | None = None
    """Law of the infra-red sensors; None from a robot that does not tell it."""

    @property
    def sensor_words(self) -> SensorWords:
        """Words for features by the sensors' places."""
        return SensorWords({each.name: each.label for each in self.sensors}, self.law)


def hello_of(body: Mapping[str, Any]) -> Hello:
    """The introduction in a decoded body. Raises WireError, which for another version says what to do."""
    _require_version(body)
    try:
        phases = body["phases"]
        if not isinstance(phases, Mapping) or set(phases) != set(range(1, len(phases) + 1)):
            raise WireError("phases have to be a map from 1, 2, 3 ... to names")
        return Hello(
            version=VERSION,
            boot=_BOOT("boot", body["boot"]),
            tick=_NUMBER("tick", body["tick"]),
            robot=_NAME("robot", body["robot"]),
            task=_NAME("task", body["task"]),
            radius=Float(1e9)("radius", body["radius"]),
            period_s=Float(10.0, "s")("period_s", body["period_s"]),
            actions=ManyOf(_NAME, most=256)("actions", body["actions"]),
            sensors=tuple(SensorPlace(*each) for each in _SENSORS("sensors", body["sensors"])),
            outline=_OUTLINE("outline", body["outline"]),
            max_m_s=Float(10.0, "m/s")("max_m_s", body["max_m_s"]),
            simulated=Flag()("simulated", body["simulated"]),
            phases=ManyOf(_NAME, most=5)("phases", [phases[number] for number in sorted(phases)]),
            behaviours=ManyOf(_NAME, most=64)("behaviours", body["behaviours"]),
            appraisals=tuple(AppraisalName(*each) for each in _APPRAISALS("appraisals", body["appraisals"])),
            trusted_from=Float(1.0)("trusted_from", body["trusted_from"]),
            mid=None if (mid := _MID("mid", body["mid"])) is None else MidIntroduction(*mid),
            seeks=Flag()("seeks", body["seeks"]),
            what=_WHAT("what", body.get("what", "")),
            law=None if (law := _LAW("law", body.get("law"))) is None else InfraredLaw(*law),
        )
    except KeyError as error:
        raise WireError(f"the robot's introduction has no {error}") from error


def _require_version(body: Mapping[str, Any]) -> None:
    version = Int(1, LARGEST_NUMBER)("version of the wire contract", body.get("v"))
    if version != VERSION:
        older = "the robot's" if version < VERSION else "this device's"
        raise WireError(
            f"the robot speaks version {version} of the wire contract, and this device version {VERSION}; bring "
            f"{older} kurt2rt up to date, so that both are the same"
        )
