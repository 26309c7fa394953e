"""Schema of `config/runtime/*.yaml`: how the service runs."""

import ipaddress
import re
from pathlib import Path
from typing import Annotated, Final, Literal

from pydantic import Field, PlainValidator

from config.settings import Settings, load_settings
from config.settings_files import find_config
from kurt2rt.channel.security.pairing import PairingFolders
from kurt2rt.platform.realtime_priority import UNIT_PRIORITY

AUTO: Final = "auto"
_HIGHEST_PRIORITY = 80


def _priority_of(value: object) -> int | Literal["auto"]:
    if value == AUTO:
        return AUTO
    if isinstance(value, int) and not isinstance(value, bool) and 0 <= value <= _HIGHEST_PRIORITY:
        return value
    raise ValueError(f"has to be {AUTO}, or a whole number from 0 to {_HIGHEST_PRIORITY}")


def page_address_of(value: object) -> str:
    """Return an address for phones, as it was given. Raises ValueError unless it is an address or a name."""
    if isinstance(value, str) and (re.fullmatch(r"[A-Za-z0-9.-]+", value) or _is_ipv6(value)):
        return value
    raise ValueError(f"has to be {AUTO}, an address or a name, without http:// and port")


def _is_ipv6(text: str) -> bool:
    try:
        return ipaddress.IPv6Address(text).scope_id is None  # a browser cannot open fe80::1%wlan0
    except ValueError:
        return False


class ServiceSettings(Settings):
    """Schema of `config/runtime/*.yaml`: the runtime settings of `kurt2rt run`."""

    name: str
    robot: str
    task: str
    world: str
    knowledge: str
    checkpoint_period_s: Annotated[float, Field(ge=0.1, le=60)]
    status_period_s: Annotated[float, Field(ge=1, le=3600)]
    real_time_priority: Annotated[int | Literal["auto"], PlainValidator(_priority_of)]
    teachers: str
    devices: str
    port: Annotated[int, Field(ge=0, le=65535)]
    page_port: Annotated[int, Field(ge=0, le=65535)]
    page_address: Annotated[str, PlainValidator(page_address_of)]
    recordings: str
    recordings_mb: Annotated[int, Field(ge=10, le=1_000_000)]

    @property
    def pairings(self) -> PairingFolders:
        """Folders of both sides of all pairings."""
        return PairingFolders(Path(self.teachers), Path(self.devices))

    @property
    def priority(self) -> int:
        """Real-time priority of the loop, 1 to 99; 0: none."""
        return 0 if self.real_time_priority == AUTO else self.real_time_priority


def load_service(name_or_path: str = "default") -> ServiceSettings:
    """Return the settings of a shipped file by name, or of a file by path. Raises SettingsError."""
    return load_settings(find_config("runtime", name_or_path), ServiceSettings)


def with_unit_priority(settings: ServiceSettings) -> ServiceSettings:
    """Return a copy of the settings in which the priority `auto` is that of a unit."""
    if settings.real_time_priority != AUTO:
        return settings
    return settings.model_copy(update={"real_time_priority": UNIT_PRIORITY})
