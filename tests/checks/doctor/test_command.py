"""`kurt2rt doctor`, as it is typed."""

import json
from pathlib import Path

from kurt2rt.checks.doctor.check_result import CheckStatus
from tests.cli.helpers import CommandLine

SUBJECTS = {
    "Python",
    "timer",
    "clock",
    "real-time priority",
    "memory lock",
    "cores",
    "CPU governor",
    "BLAS threads",
    "SQLite",
    "knowledge folder",
    "free space",
    "fsync",
    "SQLite log",
    "CAN in the kernel",
    "virtual CAN",
    "pymunk",
    "matplotlib",
}


def test_doctor_prints_every_subject_and_a_last_line(kurt2rt: CommandLine, tmp_path: Path) -> None:
    said = kurt2rt("doctor", "--folder", tmp_path, "--ticks", "3")
    assert said.exit_code == 0, said.err
    for subject in SUBJECTS:
        assert subject in said.out
    assert f" {CheckStatus.OK}, " in said.out.splitlines()[-1]


def test_a_program_gets_json_and_code_1_when_there_is_no_disk(kurt2rt: CommandLine) -> None:
    said = kurt2rt("doctor", "--json", "--folder", "/proc/kurt2rt", "--ticks", "3")
    assert said.exit_code == 1
    findings = {each["subject"]: each for each in json.loads(said.out)}
    assert [name for name, each in findings.items() if each["needed"] and each["status"] == "missing"] == [
        "knowledge folder"
    ]
    assert findings.keys() >= SUBJECTS - {"free space", "fsync", "SQLite log"}
