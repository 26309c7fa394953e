"""Description of the robot for a teacher's device."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, NamedTuple

from pydantic import Field

from kurt2rt.channel.protocol.limits import BOOT_BYTES, VERSION
from kurt2rt.channel.protocol.schema import Codec
from kurt2rt.core.message_fields import (
    Bytes,
    Finite,
    Float,
    Int,
    Number,
    OneOf,
    Share,
    Title,
    Truth,
    UpTo,
    WireError,
    Word,
)
from kurt2rt.core.perception.sensor_words import InfraredLaw, SensorWords

Metres = Annotated[float, Float(1000.0, "m")]
Words = Annotated[tuple[Word, ...], UpTo(256)]


class AppraisalName(NamedTuple):
    """Appraisal that a teacher can give to teach the critic: its name and value, as `Hello` lists them."""

    name: Word
    value: Annotated[int, OneOf((-1, 0, 1))]
    """-1, 0 or +1."""


class MidIntroduction(NamedTuple):
    """Part of `Hello` on the mid level: the kind and length of its situation, and R."""

    kind: Word
    """Kind of its situation: history, place."""
    length: Annotated[int, Int(0, 256)]
    """Number of features of the situation."""
    radius: Finite
    """Radius R of its RLA system."""


class SensorPlace(NamedTuple):
    """Name and pose of an infra-red sensor, as `Hello` tells them: x forward, y to the left."""

    name: Word
    label: Word
    x_m: Metres
    y_m: Metres
    heading_deg: Annotated[float, Float(360.0, "degrees")]


@dataclass(frozen=True, slots=True)
class Hello:
    """Answer to /hello: the robot's names, limits and features, which stay for a whole start of it."""

    version: Annotated[int, Int(VERSION, VERSION), Field(alias="v")]
    """Version of the wire contract."""
    boot: Annotated[bytes, Bytes(BOOT_BYTES)]
    tick: Number
    robot: Word
    task: Word
    radius: Finite
    """Radius R of the RLA system."""
    period_s: Annotated[float, Float(10.0, "s")]
    """Period of a tick in seconds."""
    actions: Words
    """Names of the repertoire."""
    sensors: Annotated[tuple[SensorPlace, ...], UpTo(64)]
    outline: tuple[Metres, Metres]
    """Length and width of the robot in metres."""
    max_m_s: Annotated[float, Float(10.0, "m/s")]
    simulated: Truth
    phases: Words
    """Names of the training phases; the first one's number is 1."""
    what: Title
    """Sentence on the task for its teacher; empty if the task has none."""
    law: InfraredLaw
    """Law of the infra-red sensors."""
    track_m: Metres
    """Distance between the sides that turns the robot by (right - left) / track_m, in m."""
    behaviours: Words = ("",)
    """Behaviours of the task, each with its own RLAs; a single behaviour may have an empty name."""
    appraisals: Annotated[tuple[AppraisalName, ...], UpTo(16)] = ()
    """Critic's repertoire; empty if the robot has no critic."""
    trusted_from: Share = 1.0
    """Least agreement of a trusted critic."""
    mid: MidIntroduction | None = None
    """None if no mid level chooses the behaviours."""
    seeks: Truth = False
    """True if the robot can seek a goal."""

    @property
    def sensor_words(self) -> SensorWords:
        """Texts for features, by the places of this robot's sensors."""
        return SensorWords({each.name: each.label for each in self.sensors}, self.law)


HELLO = Codec[Hello]("the robot's introduction", Hello)


def hello_of(body: Mapping[str, Any]) -> Hello:
    """Return the description in a decoded body. Raises WireError, with the remedy for another version."""
    version = body.get("v")
    if version != VERSION:  # whose other keys may be missing
        raise WireError(
            f"the robot speaks version {version} of the wire contract, and this device version {VERSION}; install "
            "the same kurt2rt on both"
        )
    return HELLO.read(body)
