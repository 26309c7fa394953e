"""Schema of `config/runtime/*.yaml`: how the service runs."""

from typing import Annotated, Final, NamedTuple

from pydantic import Field

from hal.settings import Settings, find_config, load_settings

WHILE_RUNNING: Final = "may change while the robot runs"
"""Stands beside the keys that SIGHUP takes; all others are taken at the next start."""


class ServiceSettings(Settings):
    """Settings of `kurt2rt run`."""

    name: str
    robot: str
    task: str
    world: str
    knowledge: str
    checkpoint_period_s: Annotated[float, Field(ge=0.1, le=60), WHILE_RUNNING]
    status_period_s: Annotated[float, Field(ge=1, le=3600), WHILE_RUNNING]
    real_time_priority: Annotated[int, Field(ge=0, le=80), WHILE_RUNNING]
    teachers: str
    devices: str
    port: Annotated[int, Field(ge=0, le=65535)]
    page_port: Annotated[int, Field(ge=0, le=65535)]
    recordings: str
    recordings_mb: Annotated[int, Field(ge=10, le=1_000_000), WHILE_RUNNING]


class Reloaded(NamedTuple):
    """What comes of settings that were read while the robot runs."""

    settings: ServiceSettings
    """As before, with what may change as it was read."""
    taken: tuple[str, ...]
    """Keys that changed."""
    refused: tuple[str, ...]
    """Keys that say something else in the file, and go on as they were."""


def load_service(name_or_path: str = "default") -> ServiceSettings:
    """Settings of a shipped file by name, or of a file by path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("runtime", name_or_path), ServiceSettings)


def while_running(current: ServiceSettings, read: ServiceSettings) -> Reloaded:
    """Take over what may change while the robot runs."""
    fields = ServiceSettings.model_fields
    changed = [key for key in fields if getattr(current, key) != getattr(read, key)]
    taken = tuple(key for key in changed if WHILE_RUNNING in fields[key].metadata)
    settings = current.model_copy(update={key: getattr(read, key) for key in taken})
    return Reloaded(settings, taken, tuple(key for key in changed if key not in taken))
