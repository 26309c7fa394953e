"""Settings file of a commissioned robot, with the source of each value."""

import json
import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import ValidationError

from config.settings import SettingsError
from hal.kurt2_settings import Kurt2Settings, SpeedMode, load_kurt2
from hal.robot_settings import BumperSettings
from kurt2rt.checks.commission.findings import Findings
from kurt2rt.checks.commission.progress import Progress
from kurt2rt.checks.commission.report import passed
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
    """Return the text (YAML) of the robot's settings file, with the steps as comments.

    Raises SettingsError for contradictory findings.
    """
    settings = commissioned_settings(base, progress.name, progress.findings)
    verdict = "PASSED" if passed(progress, steps) else "NOT PASSED"
    head = [
        f"# {progress.name}, commissioned with kurt2rt commission {progress.bus}: {verdict}",
        f"# What carries no date is as in {progress.base}, and explained there.",
    ]
    for step in steps:
        record = progress.steps.get(step.name)
        if record is None:
            head.append(f"# {step.name}: not taken")
            continue
        head.append(f"# {step.name}: {record.outcome}, {record.at} UTC, {record.who}")
        head += [f"#   to do: {' '.join(each.split())}" for each in record.to_do]
    return "\n".join(head) + "\n" + _render(settings.model_dump(mode="json"), _comments(base, progress))


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


def _comments(base: Kurt2Settings, progress: Progress) -> dict[str, str]:
    """Return the source of each measured value by dotted key."""
    findings = progress.findings
    comments: dict[str, str] = {}

    def note(step: str, what: str, *keys: str) -> None:
        record = progress.steps.get(step)
        if record is not None:
            comments.update(dict.fromkeys(keys, f"{what}, {record.at[:10]}, {record.who}"))

    if findings.speed_mode is not None:
        note("modes", "answered", "can.speed_mode")
    if findings.speed_mode is SpeedMode.SPEED and findings.full_speed_m_s is not None:
        note("modes", "measured", "motors.full_speed_m_s")
    if findings.controller_watchdog_s is not None:
        note("stop", "measured", "motors.controller_watchdog_s")
    if findings.law is not None:
        law = ("numerator_counts_m", "offset_m", "bias_counts", "near_m", "far_m", "floor_counts", "plateau_counts")
        note("infrared", "fitted", *(f"infrared.{key}" for key in law))
        note("infrared", "scaled with plateau_counts", "infrared.fold_back_counts_per_m")
    for at, sensor in enumerate(base.infrared.sensors):
        key = f"infrared.sensors.{at}"
        if sensor.name in findings.dead_sensors:
            note("sensors", "DEAD, no channel answered", key)
        elif sensor.name in findings.channels:
            other = "" if findings.channels[sensor.name] == sensor.channel else f", was {sensor.channel}"
            note("sensors", f"by hand{other}", key)
        else:
            comments[key] = "not tried"
    for bit, bumper in enumerate(_bumpers(base.bumpers, findings)):
        if bumper.name in findings.bumper_bits:
            note("bumpers", f"bit {bit} by hand", f"bumpers.{bit}")
        else:
            comments[f"bumpers.{bit}"] = "not tried"
    return comments


def _render(content: Mapping[str, Any], comments: Mapping[str, str]) -> str:
    lines: list[str] = []
    for key, value in content.items():
        if isinstance(value, dict):
            lines += ["", f"{key}:", *_rows(value, key, comments)]
        elif isinstance(value, list):
            lines += _list(key, value, "", key, comments)
        else:
            lines.append(_commented(f"{key}: {_scalar(value)}", comments.get(key)))
    return "\n".join(lines) + "\n"


def _rows(section: Mapping[str, Any], path: str, comments: Mapping[str, str]) -> list[str]:
    lines: list[str] = []
    for key, value in section.items():
        dotted = f"{path}.{key}"
        if isinstance(value, list) and value and isinstance(value[0], dict):
            lines += _list(key, value, "  ", dotted, comments)
        else:
            lines.append(_commented(f"  {key}: {_scalar(value)}", comments.get(dotted)))
    return lines


def _list(key: str, values: list[Any], indent: str, path: str, comments: Mapping[str, str]) -> list[str]:
    if not values:
        return [f"{indent}{key}: []"]
    items = [f"{indent}  - {_scalar(each)}" for each in values]
    return [
        *([] if indent else [""]),
        f"{indent}{key}:",
        *(_commented(item, comments.get(f"{path}.{at}")) for at, item in enumerate(items)),
    ]


def _commented(line: str, comment: str | None) -> str:
    return line if comment is None else f"{line}  # {comment}"


def _scalar(value: Any) -> str:
    """Return a value on one line; floats without an exponent, which YAML would read as text."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{key}: {_scalar(each)}" for key, each in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(_scalar(each) for each in value) + "]"
    if isinstance(value, float):
        return np.format_float_positional(value, trim="0")
    # As an item of a list, so that YAML quotes what would end an item.
    return yaml.safe_dump([value], default_flow_style=True, width=math.inf, allow_unicode=True).strip()[1:-1]
