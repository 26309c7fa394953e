"""Description of the robot for a teacher's device."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from kurt2rt.channel.protocol.limits import BOOT_BYTES, VERSION
from kurt2rt.core.perception.sensor_words import InfraredLaw, SensorWords
from kurt2rt.core.teaching.message_fields import (
    LARGEST_NUMBER,
    Bytes,
    Flag,
    Float,
    Int,
    ListOf,
    OrNone,
    Row,
    Text,
    WireError,
)

_NAME = Text(64)
_METRES = Float(1000.0, "m")
_NUMBER = Int(0, LARGEST_NUMBER)
_BOOT = Bytes(BOOT_BYTES)
_SENSORS = ListOf(Row((_NAME, _NAME, _METRES, _METRES, Float(360.0, "degrees"))), most=64)
_APPRAISALS = ListOf(Row((_NAME, Int(-1, 1))), most=16)
_MID = OrNone(Row((_NAME, Int(0, 256), Float(1e9))))
_OUTLINE = Row((_METRES, _METRES))
_WHAT = Text(128)
_COUNTS = Float(1e6, "counts")
_LAW = Row((_COUNTS, _METRES, _COUNTS, _METRES, _METRES, _COUNTS))


class AppraisalName(NamedTuple):
    """Name of an appraisal for teaching the critic, with its value."""

    name: str
    value: int
    """-1, 0 or +1."""


class MidIntroduction(NamedTuple):
    """Part of `Hello` on the mid level: the kind and length of its situation, and R."""

    kind: str
    """Kind of its situation: history, place."""
    length: int
    """Number of features of the situation."""
    radius: float
    """Radius R of its RLA system."""


class SensorPlace(NamedTuple):
    """Pose of an infra-red sensor in the robot's frame: x forward, y to the left."""

    name: str
    label: str
    x_m: float
    y_m: float
    heading_deg: float


@dataclass(frozen=True, slots=True)
class Hello:
    """Answer to /hello: the robot's names, limits and features, which stay for a whole start of it."""

    version: int
    """Version of the wire contract."""
    boot: bytes
    tick: int
    robot: str
    task: str
    radius: float
    """Radius R of the RLA system."""
    period_s: float
    """Period of a tick in seconds."""
    actions: tuple[str, ...]
    """Names of the repertoire."""
    sensors: tuple[SensorPlace, ...]
    outline: tuple[float, float]
    """Length and width of the robot in metres."""
    max_m_s: float
    simulated: bool
    phases: tuple[str, ...]
    """Names of the training phases; the first one's number is 1."""
    what: str
    """Sentence on the task for its teacher; empty if the task has none."""
    law: InfraredLaw
    """Law of the infra-red sensors."""
    track_m: float
    """Distance between the sides that turns the robot by (right - left) / track_m, in m."""
    behaviours: tuple[str, ...] = ("",)
    """Behaviours of the task, each with its own RLAs; a single behaviour may have an empty name."""
    appraisals: tuple[AppraisalName, ...] = ()
    """Critic's repertoire; empty if the robot has no critic."""
    trusted_from: float = 1.0
    """Least agreement of a trusted critic."""
    mid: MidIntroduction | None = None
    """None if no mid level chooses the behaviours."""
    seeks: bool = False
    """True if the robot can seek a goal."""

    @property
    def sensor_words(self) -> SensorWords:
        """Texts for features, by the places of this robot's sensors."""
        return SensorWords({each.name: each.label for each in self.sensors}, self.law)


def hello_of(body: Mapping[str, Any]) -> Hello:
    """Return the description in a decoded body. Raises WireError, with the remedy for another version."""
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
            actions=ListOf(_NAME, most=256)("actions", body["actions"]),
            sensors=tuple(SensorPlace(*each) for each in _SENSORS("sensors", body["sensors"])),
            outline=_OUTLINE("outline", body["outline"]),
            max_m_s=Float(10.0, "m/s")("max_m_s", body["max_m_s"]),
            simulated=Flag()("simulated", body["simulated"]),
            phases=ListOf(_NAME, most=5)("phases", [phases[number] for number in sorted(phases)]),
            behaviours=ListOf(_NAME, most=64)("behaviours", body["behaviours"]),
            appraisals=tuple(AppraisalName(*each) for each in _APPRAISALS("appraisals", body["appraisals"])),
            trusted_from=Float(1.0)("trusted_from", body["trusted_from"]),
            mid=None if (mid := _MID("mid", body["mid"])) is None else MidIntroduction(*mid),
            seeks=Flag()("seeks", body["seeks"]),
            what=_WHAT("what", body["what"]),
            law=InfraredLaw(*_LAW("law", body["law"])),
            track_m=_METRES("track_m", body["track_m"]),
        )
    except KeyError as error:
        raise WireError(f"the robot's introduction has no {error}") from error


def _require_version(body: Mapping[str, Any]) -> None:
    version = Int(1, LARGEST_NUMBER)("version of the wire contract", body.get("v"))
    if version != VERSION:
        raise WireError(
            f"the robot speaks version {version} of the wire contract, and this device version {VERSION}; install "
            "the same kurt2rt on both"
        )
