"""Schema of a map_server map, and of a world that is built on one."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from hal.settings import Settings
from simbridge.world_settings import StartPoseSettings

Share = Annotated[float, Field(ge=0, le=1)]


class MapSettings(Settings):
    """The YAML file beside the image, with map_server's own keys."""

    image: str
    """PGM or PNG; relative to the YAML file."""
    resolution: Annotated[float, Field(gt=0, le=1)]
    """Metres per cell."""
    origin: tuple[float, float, float]
    """Where the lower left corner of the image is, in metres, and how it is turned, in radians, counter-clockwise."""
    negate: bool | Literal[0, 1]
    """0: dark is occupied; 1: bright is."""
    occupied_thresh: Share
    free_thresh: Share
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    @model_validator(mode="after")
    def _has_room_between_its_thresholds(self) -> Self:
        if self.free_thresh >= self.occupied_thresh:
            raise ValueError(f"free_thresh must be below occupied_thresh, {self.occupied_thresh}")
        return self


class MapWorldSettings(Settings):
    """A world on a map, with start poses of one's own choice, in the map's frame as RViz shows it."""

    map: str
    """The map's YAML file, relative to this one."""
    infrared_rays: Literal[1, 3] | None = None
    """Default: 3 when something on the map is thinner than the gap between two sensors."""
    start_poses: Annotated[tuple[StartPoseSettings, ...], Field(min_length=1)]
