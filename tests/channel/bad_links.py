"""Forty bad links between a teacher and his robot."""

from dataclasses import dataclass, replace

from tests.channel.lossy_link import Weather


@dataclass(frozen=True, slots=True)
class BadLink:
    """Return the same weather both ways, drawn for each direction on its own."""

    name: str
    weather: Weather
    hole: bool = False
    """Nothing passes for two seconds in the middle of the lessons."""
    seed: int = 0

    @property
    def missing(self) -> float:
        """Share of one direction's datagrams that is not there when it counts: lost, or seconds late."""
        return 1.0 - (1.0 - self.weather.loss) * (1.0 - self.weather.held_back)

    @property
    def holds_back(self) -> bool:
        """Return whether some datagrams come seconds later."""
        return self.weather.held_back > 0.0


_LOSSES = (0.0, 0.1, 0.3, 0.6)
_NEAR = Weather(delay_s=0.002)
_LATE = Weather(delay_s=0.005, jitter_s=0.035)
_KINDS = (
    BadLink("clean", _NEAR),
    BadLink("jitter", _LATE),
    BadLink("doubled", replace(_NEAR, doubled=0.05)),
    BadLink("overtaken", replace(_NEAR, overtaken=0.2, overtaken_s=0.06)),
    BadLink("held back", replace(_NEAR, held_back=0.05)),
    BadLink("hole", _NEAR, hole=True),
    BadLink("jitter, doubled", replace(_LATE, doubled=0.05)),
    BadLink("overtaken, held back", replace(_NEAR, overtaken=0.2, overtaken_s=0.06, held_back=0.05)),
    BadLink("jitter, hole", _LATE, hole=True),
    BadLink("all", replace(_LATE, doubled=0.05, overtaken=0.2, overtaken_s=0.06, held_back=0.05), hole=True),
)

BAD_LINKS = tuple(
    BadLink(f"{loss:.0%} lost, {kind.name}", replace(kind.weather, loss=loss), kind.hole, seed)
    for seed, (loss, kind) in enumerate((loss, kind) for loss in _LOSSES for kind in _KINDS)
)
