"""Settings file of a commissioned robot, with the source of each value."""

import json
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import yaml
from pydantic import ValidationError

from config.settings import SettingsError
from hal.kurt2_settings import Kurt2Settings, SpeedMode, load_kurt2
from hal.robot_settings import BumperSettings
from kurt2rt.checks.commission.progress import Findings, Progress
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


def _render(content: Mapping[str, Any], comments: Mapping[str, str]) -> str:
    """Return YAML with a comment in the line of each dotted key."""
    text = yaml.dump(_in_rows(content), Dumper=_Dumper, sort_keys=False, width=math.inf, allow_unicode=True)
    lines = text.splitlines()
    for key, line in _lines_of(yaml.compose(text), ""):
        if key in comments:
            lines[line] += f"  # {comments[key]}"
    return "".join(f"\n{line}\n" if re.fullmatch(r"\w+:", line) else f"{line}\n" for line in lines)


def _in_rows(value: Any) -> Any:
    """Return a content whose lists hold mappings of one line each."""
    if isinstance(value, dict):
        return {key: _in_rows(each) for key, each in value.items()}
    return [_Row(each) if isinstance(each, dict) else each for each in value] if isinstance(value, list) else value


def _lines_of(node: yaml.Node | None, key: str) -> Iterator[tuple[str, int]]:
    """Yield each dotted key within a node, with the number of its line from 0."""
    if isinstance(node, yaml.MappingNode):
        within = [(name.value, each) for name, each in node.value]
    else:
        within = list(enumerate(node.value)) if isinstance(node, yaml.SequenceNode) else []
    for name, each in within:
        dotted = f"{key}.{name}" if key else str(name)
        yield dotted, each.start_mark.line
        yield from _lines_of(each, dotted)
