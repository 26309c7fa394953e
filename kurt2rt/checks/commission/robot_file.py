"""Settings file of a commissioned robot, with the record of all steps at its head."""

import json
import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import ValidationError

from config.settings import SettingsError
from hal.kurt2_settings import Kurt2Settings, SpeedMode, load_kurt2
from hal.robot_settings import BumperSettings
from kurt2rt.checks.commission.progress import Findings, Progress
from kurt2rt.checks.commission.report import as_text
from kurt2rt.checks.commission.step import CommissionStep
from kurt2rt.platform.durable_files import write_durably


def commissioned_settings(base: Kurt2Settings, name: str, findings: Findings) -> Kurt2Settings:
    """Return the settings of `base` under a new name, with all findings.

    Raises SettingsError for contradictory findings.
    """
    content = base.model_dump(mode="json")
    content["name"] = name
    if findings.speed_mode is not None:
        content["can"]["speed_mode"] = findings.speed_mode.value
    if findings.speed_mode is SpeedMode.SPEED and findings.full_speed_m_s is not None:
        content["motors"]["full_speed_m_s"] = findings.full_speed_m_s
    if findings.controller_watchdog_s is not None:
        content["motors"]["controller_watchdog_s"] = findings.controller_watchdog_s
    _require_own_channels(base, findings)
    for sensor in content["infrared"]["sensors"]:
        sensor["channel"] = findings.channels.get(sensor["name"], sensor["channel"])
    if findings.law is not None:
        scale = findings.law.plateau_counts / base.infrared.plateau_counts
        content["infrared"] |= findings.law.model_dump()
        # What is nearer than the law reaches keeps its shape.
        content["infrared"]["fold_back_counts_per_m"] = round(base.infrared.fold_back_counts_per_m * scale, 1)
    content["bumpers"] = [each.model_dump(mode="json") for each in _bumpers(base.bumpers, findings)]
    try:
        # Through JSON, as the loader of settings does it.
        return Kurt2Settings.model_validate_json(json.dumps(content))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        raise SettingsError(f"what was found makes no robot: {key}: {first['msg']}", do="repeat that step") from error


def robot_file(base: Kurt2Settings, progress: Progress, steps: Sequence[CommissionStep]) -> str:
    """Return the text (YAML) of the robot's settings file, with the record of the steps as comments.

    Raises SettingsError for contradictory findings.
    """
    settings = commissioned_settings(base, progress.name, progress.findings)
    head = [*as_text(progress, steps).splitlines(), "", f"All else is as in {progress.base}, and explained there."]
    content = yaml.dump(
        _in_rows(settings.model_dump(mode="json")),
        Dumper=_Dumper,
        sort_keys=False,
        width=math.inf,
        allow_unicode=True,
    )
    return "".join(f"# {line}".rstrip() + "\n" for line in head) + content


def write_robot_file(
    path: Path, base: Kurt2Settings, progress: Progress, steps: Sequence[CommissionStep]
) -> Kurt2Settings:
    """Write the robot's settings file and return its content, loaded as the robot's program loads it.

    Raises SettingsError for contradictory findings, OSError if it cannot be written.
    """
    text = robot_file(base, progress, steps)
    write_durably(path, text)
    return load_kurt2(str(path))


def _require_own_channels(base: Kurt2Settings, findings: Findings) -> None:
    """Raise SettingsError if a found channel belongs to an untried sensor of the table."""
    claimed = {channel: name for name, channel in findings.channels.items()}
    for sensor in base.infrared.sensors:
        owner = claimed.get(sensor.channel)
        if sensor.name not in findings.channels and owner is not None:
            raise SettingsError(
                f"{sensor.name} has no channel: {sensor.channel}, which the table gives it, is {owner}'s",
                do=f"find {sensor.name}'s with --only sensors",
            )


def _bumpers(table: Sequence[BumperSettings], findings: Findings) -> Sequence[BumperSettings]:
    """Return the table in the order of the found bits."""
    bits = {bumper.name: findings.bumper_bits.get(bumper.name, at) for at, bumper in enumerate(table)}
    if sorted(bits.values()) != list(range(len(table))):
        said = ", ".join(f"{name} {bit}" for name, bit in bits.items())
        raise SettingsError(
            f"bumper bits must be 0 to {len(table) - 1}, each once, but are: {said}", do="find them with --only bumpers"
        )
    return sorted(table, key=lambda bumper: bits[bumper.name])


class _Row(dict[str, Any]):
    """Mapping on a line of its own."""


class _Dumper(yaml.SafeDumper):
    """Writer of YAML with floats without an exponent."""


_Dumper.add_representer(float, lambda dumper, value: _positional(dumper, value))
_Dumper.add_representer(
    _Row, lambda dumper, row: dumper.represent_mapping("tag:yaml.org,2002:map", row, flow_style=True)
)


def _positional(dumper: _Dumper, value: float) -> yaml.ScalarNode:
    return dumper.represent_scalar("tag:yaml.org,2002:float", np.format_float_positional(value, trim="0"))


def _in_rows(value: Any) -> Any:
    """Return a content whose lists hold mappings of one line each."""
    if isinstance(value, dict):
        return {key: _in_rows(each) for key, each in value.items()}
    return [_Row(each) if isinstance(each, dict) else each for each in value] if isinstance(value, list) else value
