"""Schema of `config/wires/*.yaml`: how fast the wire between robot and notebook is, and what goes wrong on it."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator

from hal.settings import Settings, find_config, load_settings

Share = Annotated[float, Field(ge=0, le=1)]
Seconds = Annotated[float, Field(ge=0, le=3600)]


class SendingOrder(StrEnum):
    """Which of its frames a node offers to the wire first."""

    FIFO = "fifo"
    """As it was told, which is what SocketCAN does."""
    IDENTIFIER = "identifier"
    """The best identifier first."""
    MAILBOX = "mailbox"
    """The best identifier first, one frame of each: a newer one takes the place of one that waits, as in the message
    objects of the robot's controllers."""


class NodeSettings(Settings):
    """One CAN controller with its queue."""

    order: SendingOrder
    queue_frames: Annotated[int, Field(ge=1, le=4096)]
    restart_s: Seconds | None
    """From bus-off to a new start, Linux's restart-ms; None: it stays off until it is opened anew."""


class LossSettings(Settings):
    """A frame is carried but a receiver misses it: its buffer was overrun. Drawn for each receiver."""

    share: Share
    """Of all frames that `shares_by_id` does not name."""
    shares_by_id: tuple[tuple[Annotated[int, Field(ge=0, le=0x7FF)], Share], ...]
    """Pairs of a standard identifier and its share."""


class NoiseSettings(Settings):
    """What destroys frames on their way, so that their sender repeats them."""

    destroyed_share: Share
    """Of all transmissions, at any time."""
    bursts_s: tuple[tuple[Seconds, Seconds], ...]
    """Beginnings and ends of noise in which no transmission survives, in time of the wire."""
    burst_gap_s: Seconds
    """Mean time from one burst of chance to the next, both exponential; 0: there are none."""
    burst_length_s: Seconds
    """Mean length of a burst of chance."""

    @model_validator(mode="after")
    def _bursts_go_forward(self) -> Self:
        ends = [end for burst in self.bursts_s for end in burst]
        if ends != sorted(ends):
            raise ValueError("bursts_s must be pairs [begin, end], each after the one before")
        return self


class WireSettings(Settings):
    """The wire, and the controllers at its two ends."""

    name: str
    bit_rate_bit_s: Annotated[int, Field(ge=1000, le=1_000_000_000)]
    notebook_phase_s: Annotated[float, Field(ge=0, lt=1)]
    """In simulated time: how long after the robot's cycle began the notebook's tick looks at the bus."""
    robot: NodeSettings
    notebook: NodeSettings
    loss: LossSettings
    noise: NoiseSettings


def load_wire(name_or_path: str) -> WireSettings:
    """Settings of a shipped wire by name, or of a file by path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("wires", name_or_path), WireSettings)
