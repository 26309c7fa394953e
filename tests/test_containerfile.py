"""Containerfile: the robot's program runs as a user without rights, with all packages of the project."""

import json
import re
import tomllib

import pytest

from tests.cli.helpers import ROOT

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
TEXT = re.sub(r"\\\n", "", (ROOT / "Containerfile").read_text(encoding="utf-8"))
BUILD, FINAL = ([line.split(maxsplit=1) for line in stage.splitlines()] for stage in TEXT.split("\nFROM ")[1:])


def value_of(instruction: str) -> str:
    """Return the arguments of an instruction of the final stage, which has it once."""
    (found,) = (line[1] for line in FINAL if line[0] == instruction)
    return found


def test_image_runs_without_rights_of_root() -> None:
    assert int(value_of("USER")) > 0
    made = next(index for index, line in enumerate(FINAL) if "useradd" in line[-1])
    assert f"--uid {value_of('USER')}" in FINAL[made][1]


def test_both_stages_are_of_one_image_by_its_digest() -> None:
    assert re.search(r"^ARG BASE=debian:12-slim@sha256:[0-9a-f]{64}$", TEXT, re.MULTILINE)
    assert re.findall(r"^FROM (\S+)", TEXT, re.MULTILINE) == ["${BASE}", "${BASE}"]


def test_image_starts_the_program_of_the_project() -> None:
    (program,) = json.loads(value_of("ENTRYPOINT"))
    assert program.rpartition("/")[2] in PROJECT["project"]["scripts"]
    assert json.loads(value_of("CMD"))[:2] == ["run", "--service"]
    assert value_of("STOPSIGNAL") == "SIGTERM"


def test_image_builds_all_packages_of_the_project() -> None:
    copied = {line[1].split()[0] for line in BUILD if line[:1] == ["COPY"]}
    assert {each.rstrip("*") for each in PROJECT["tool"]["setuptools"]["packages"]["find"]["include"]} <= copied


@pytest.mark.parametrize("port", ["5683/udp", "8642/tcp"])
def test_image_exposes_the_ports_of_the_default_settings(port: str) -> None:
    settings = (ROOT / "config/runtime/default.yaml").read_text(encoding="utf-8")
    assert port in value_of("EXPOSE").split()
    assert re.search(rf"port: {port.partition('/')[0]}\b", settings)


def test_extras_of_the_image_exist() -> None:
    (extras,) = (line[1].partition("=")[2] for line in BUILD if line[:1] == ["ARG"])
    assert set(extras.split(",")) <= PROJECT["project"]["optional-dependencies"].keys()
