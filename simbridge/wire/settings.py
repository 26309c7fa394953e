"""Schema of `config/wires/*.yaml`: speed and faults of the wire between robot and notebook."""

from enum import StrEnum
from typing import Annotated, Self

from pydantic import Field, model_validator

from hal.settings import Settings, load_settings
from hal.settings_files import find_config

Share = Annotated[float, Field(ge=0, le=1)]
Seconds = Annotated[float, Field(ge=0, le=3600)]


class SendingOrder(StrEnum):
    """Order in which a node offers its frames."""

    FIFO = "fifo"
    """Order of sending, as in SocketCAN."""
    IDENTIFIER = "identifier"
    """Lowest identifier first."""
    MAILBOX = "mailbox"
    """Lowest identifier first, one frame of each: a newer one replaces a waiting one, as in the message objects of the
    robot's controllers.
    """


class NodeSettings(Settings):
    """CAN controller with its transmit queue."""

    order: SendingOrder
    queue_frames: Annotated[int, Field(ge=1, le=4096)]
    restart_s: Seconds | None
    """Time from bus-off to the restart (Linux: restart-ms); None: bus-off until it is reopened."""


class LossSettings(Settings):
    """Loss of carried frames at a receiver, such as a buffer overrun; drawn per receiver."""

    share: Share
    """Loss probability of identifiers that `shares_by_id` does not list."""
    shares_by_id: tuple[tuple[Annotated[int, Field(ge=0, le=0x7FF)], Share], ...]
    """Pairs of a standard identifier and its loss probability."""


class NoiseSettings(Settings):
    """Noise that destroys frames, so that their sender repeats them."""

    destroyed_share: Share
    """Probability that a transmission is destroyed."""
    bursts_s: tuple[tuple[Seconds, Seconds], ...]
    """Begin and end of each fixed burst, in which no transmission survives, in the wire's time."""
    burst_gap_s: Seconds
    """Mean time between random bursts, exponentially distributed; 0: none."""
    burst_length_s: Seconds
    """Mean length of a random burst, exponentially distributed."""

    @model_validator(mode="after")
    def _bursts_go_forward(self) -> Self:
        ends = [end for burst in self.bursts_s for end in burst]
        if ends != sorted(ends):
            raise ValueError("bursts_s must be ascending pairs [begin, end]")
        return self


class WireSettings(Settings):
    """Wire with the controllers at its two ends."""

    name: str
    bit_rate_bit_s: Annotated[int, Field(ge=1000, le=1_000_000_000)]
    notebook_phase_s: Annotated[float, Field(ge=0, lt=1)]
    """Simulated time from the begin of the robot's cycle to the notebook's tick."""
    robot: NodeSettings
    notebook: NodeSettings
    loss: LossSettings
    noise: NoiseSettings


def load_wire(name_or_path: str) -> WireSettings:
    """Return the settings of a wire by name or path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("wires", name_or_path), WireSettings)
