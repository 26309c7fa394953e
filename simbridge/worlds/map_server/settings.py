"""Schema of a map_server map, and of a world based on one."""

from pathlib import Path
from typing import Annotated, Literal, Self

from pydantic import AliasChoices, ConfigDict, Field, model_validator

from hal.settings import Settings, SettingsError
from simbridge.worlds.world_settings import StartPoseSettings

Share = Annotated[float, Field(ge=0, le=1)]


class MapSettings(Settings):
    """YAML file of a map with map_server's keys; keys of other programs are allowed."""

    model_config = ConfigDict(extra="ignore")

    image: Annotated[str, Field(validation_alias=AliasChoices("image", "Image"))]
    """PGM or PNG file, relative to the YAML file."""
    resolution: Annotated[float, Field(gt=0, le=1)]
    """Metres per cell."""
    origin: tuple[float, float, float]
    """Position in m and counter-clockwise rotation in rad of the image's lower left corner."""
    negate: bool | Literal[0, 1]
    """0 if dark cells are occupied, 1 if bright ones are."""
    occupied_thresh: Share
    free_thresh: Share
    mode: Literal["trinary", "scale", "raw"] = "trinary"

    @model_validator(mode="after")
    def _has_room_between_its_thresholds(self) -> Self:
        if self.free_thresh >= self.occupied_thresh:
            raise ValueError(
                f"free_thresh must be below occupied_thresh (got {self.free_thresh}, allowed < {self.occupied_thresh})"
            )
        return self


def image_error(source: Path, what: str, do: str) -> SettingsError:
    """Return the error that refuses a map's image: `what` is wrong, and what to `do`."""
    return SettingsError(what, where=f"{source}: image", do=do)


class MapWorldSettings(Settings):
    """World on a map with start poses in the map's frame, as RViz shows it."""

    map: str
    """YAML file of the map, relative to this file."""
    infrared_rays: Literal[1, 3] | None = None
    """Rays per sensor; by default 3 if something on the map is thinner than the gap between two sensors."""
    start_poses: Annotated[tuple[StartPoseSettings, ...], Field(min_length=1)]
