"""Schema of `config/runtime/*.yaml`: how the service runs."""

from typing import Annotated

from pydantic import Field

from hal.settings import Settings, find_config, load_settings


class ServiceSettings(Settings):
    """Settings of `kurt2rt run`."""

    name: str
    robot: str
    task: str
    world: str
    knowledge: str
    checkpoint_period_s: Annotated[float, Field(ge=0.1, le=60)]
    status_period_s: Annotated[float, Field(ge=1, le=3600)]
    real_time_priority: Annotated[int, Field(ge=0, le=80)]
    teachers: str
    devices: str
    port: Annotated[int, Field(ge=0, le=65535)]
    page_port: Annotated[int, Field(ge=0, le=65535)]


def load_service(name_or_path: str = "default") -> ServiceSettings:
    """Settings of a shipped file by name, or of a file by path. Raises hal.settings.SettingsError."""
    return load_settings(find_config("runtime", name_or_path), ServiceSettings)
