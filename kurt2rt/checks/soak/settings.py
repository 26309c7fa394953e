"""Schema of `config/soak/*.yaml`: what a day of the robot is like."""

from typing import Annotated, Self

from pydantic import Field, model_validator

from hal.settings import Settings, find_config, load_settings

Seconds = Annotated[float, Field(ge=0, le=100_000)]
Share = Annotated[float, Field(ge=0, le=1)]
Span = tuple[Seconds, Seconds]
"""Anything between the two, by chance."""


class MoodSettings(Settings):
    """How a teacher is for a while."""

    share: Share
    """How often it is the mood that comes next."""
    lasts_s: Span
    phase: Annotated[int, Field(ge=1, le=5)]
    """The training phase that begins with it."""
    reaction_s: Seconds
    """From a question to its answer, and from an alarm to `resume`."""
    patience_s: Seconds
    error_rate: Share
    """Share of answers and corrections that are wrong."""
    most_corrections: Annotated[int, Field(ge=0, le=100_000)]
    """Then he only answers, for as long as the mood lasts; the first ones of a day do not count."""
    stops_every_s: Seconds = 0.0
    """Mean time from one stop to the next; 0: never. So with the others."""
    undoes_every_s: Seconds = 0.0
    rewards_every_s: Seconds = 0.0
    appraises_every_s: Seconds = 0.0
    there: bool = True
    """False: nobody is heard, and the robot stands."""


class LimitSettings(Settings):
    """What must not be exceeded."""

    memory_mb: Annotated[float, Field(gt=0, le=1000)]
    waiting: Annotated[int, Field(gt=0, le=10_000)]
    odometry_m: Annotated[float, Field(gt=0, le=1)]


class SoakSettings(Settings):
    """All of it."""

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
    wires: Annotated[dict[str, Share], Field(min_length=1)]
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
    """A shipped day by name, or one by path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("soak", name_or_path), SoakSettings)
