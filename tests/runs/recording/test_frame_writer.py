"""Logs in the words of other CAN tools; a log that exists is never written over."""

import re
from pathlib import Path

import can
import pytest

from kurt2rt.runs.recording.can_log import ENDINGS, LogFile
from kurt2rt.runs.recording.recording_error import RecordingError

FRAMES = (
    can.Message(
        timestamp=1700000000.25, arbitration_id=0x09, is_extended_id=False, data=bytes(range(8)), channel="can0"
    ),
    can.Message(
        timestamp=1700000000.5,
        arbitration_id=0x01,
        is_extended_id=False,
        data=bytes.fromhex("000103FF0103FF00"),
        channel="can0",
        is_rx=False,
    ),
    can.Message(timestamp=1700000000.75, arbitration_id=0x1ABCDEF0, is_extended_id=True, data=b"\x01", channel="can0"),
    can.Message(
        timestamp=1700000001.0, arbitration_id=0x07, is_extended_id=False, is_remote_frame=True, dlc=8, channel="can0"
    ),
)
BUS_OFF = can.Message(timestamp=1700000002.0, arbitration_id=0x40, is_error_frame=True, dlc=8, data=bytes(8))
READABLE_WITHOUT_ITS_END = [each for each in ENDINGS if each != ".blf"]


@pytest.mark.parametrize("ending", ENDINGS)
def test_can_log_is_readable_by_python_can(tmp_path: Path, ending: str) -> None:
    file = LogFile(tmp_path / f"drive{ending}")
    file.write(FRAMES[:2])
    file.write(FRAMES[2:3])
    file.close()
    with can.LogReader(file.path) as reader:
        read = list(reader)
    assert [(each.arbitration_id, each.is_extended_id, bytes(each.data)) for each in read] == [
        (each.arbitration_id, each.is_extended_id, bytes(each.data)) for each in FRAMES[:3]
    ]
    assert [read[1].timestamp - read[0].timestamp, read[2].timestamp - read[1].timestamp] == pytest.approx(
        [0.25, 0.25], abs=0.001
    )


def test_a_candump_log_reads_as_candumps_own(tmp_path: Path) -> None:
    file = LogFile(tmp_path / "drive.log")
    file.write([*FRAMES, BUS_OFF])
    file.close()
    assert file.path.read_text(encoding="ascii").splitlines() == [
        "(1700000000.250000) can0 009#0001020304050607 R",
        "(1700000000.500000) can0 001#000103FF0103FF00 T",
        "(1700000000.750000) can0 1ABCDEF0#01 R",
        "(1700000001.000000) can0 007#R R",
        "(1700000002.000000) vcan0 20000040#0000000000000000 R",
    ]


@pytest.mark.parametrize("ending", READABLE_WITHOUT_ITS_END)
def test_can_log_survives_a_killed_program(tmp_path: Path, ending: str) -> None:
    file = LogFile(tmp_path / f"drive{ending}")
    file.write(FRAMES[:2])
    with can.LogReader(file.path) as reader:
        assert [each.arbitration_id for each in reader] == [0x09, 0x01]
    file.close()


def test_a_log_that_exists_is_kept_and_the_new_one_is_numbered(tmp_path: Path) -> None:
    first = tmp_path / "drive.monday.log"
    first.write_bytes(b"the log of the crash")
    names = []
    for _ in range(2):
        file = LogFile(first)
        file.close()
        names.append(file.path.name)
    assert names == ["drive.monday-2.log", "drive.monday-3.log"]
    assert first.read_bytes() == b"the log of the crash"


@pytest.mark.parametrize("name", ["drive", "drive.txt", "drive.db", ".log", "drive.log.bz2"])
def test_another_kind_of_file_is_refused_and_not_made(tmp_path: Path, name: str) -> None:
    with pytest.raises(RecordingError, match=rf"{re.escape(name)}.*\.log, "):
        LogFile(tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_is_not_there_is_the_systems_error(tmp_path: Path) -> None:
    with pytest.raises(FileNotFoundError):
        LogFile(tmp_path / "none" / "drive.log")
