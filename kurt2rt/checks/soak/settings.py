"""Schema of `config/soak/*.yaml`: one simulated day of the robot."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hal.settings import Settings, load_settings
from hal.settings_files import find_config

Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
Span = tuple[Seconds, Seconds]
"""Range of a random value."""


class MoodSettings(Settings):
    """Behaviour of a teacher for a while."""

    share: Share
    """Probability of this mood being the next."""
    lasts_s: Span
    phase: Annotated[int, Field(ge=1, le=5)]
    """Training phase at its beginning."""
    reaction_s: Seconds
    """Time from a question to its answer, and from an alarm to `resume`."""
    patience_s: Seconds
    error_rate: Share
    """Share of wrong answers and corrections."""
    most_corrections: Annotated[int, Field(ge=0, le=100_000)]
    """Corrections in one mood, then answers only; the day's first ones do not count."""
    stops_every_s: Seconds = 0.0
    """Mean interval between stops; 0: never. The other intervals have the same meaning."""
    undoes_every_s: Seconds = 0.0
    rewards_every_s: Seconds = 0.0
    appraises_every_s: Seconds = 0.0
    there: bool = True
    """False: no command is sent, and the robot stands."""


class LimitSettings(Settings):
    """Limits of the checks."""

    memory_mb: Annotated[float, Field(gt=0, le=1000)]
    waiting: Annotated[int, Field(gt=0, le=10_000)]
    odometry_m: Annotated[float, Field(gt=0, le=1)]


class SoakSettings(Settings):
    """Schedule, faults and teacher of a soak."""

    name: str
    faults: str
    task: str
    world: str
    checkpoint_period_s: Annotated[float, Field(ge=0.1, le=60)]
    recordings_mb: Annotated[int, Field(ge=20, le=1_000_000)]
    lives_s: Span
    down_s: Span
    fault_gap_s: Annotated[float, Field(gt=0, le=100_000)]
    picked_up_after_s: Annotated[float, Field(gt=0, le=1000)]
    wires: Annotated[dict[Literal["none", "slow", "lossy"], Share], Field(min_length=1)]
    first_corrections: Annotated[int, Field(ge=0, le=100_000)]
    moods: Annotated[dict[str, MoodSettings], Field(min_length=1)]
    limits: LimitSettings

    @model_validator(mode="after")
    def _spans_go_forward(self) -> Self:
        for low_s, high_s in (self.lives_s, self.down_s, *(mood.lasts_s for mood in self.moods.values())):
            if low_s > high_s:
                raise ValueError(f"[{low_s:g}, {high_s:g}] is no span: the smaller number stands first")
        return self


def load_soak(name_or_path: str = "day") -> SoakSettings:
    """Load a shipped day by name, or one by path. Raises SettingsError."""
    return load_settings(find_config("soak", name_or_path), SoakSettings)
