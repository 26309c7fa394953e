"""`kurt2rt status` of a running robot program."""

import json
from pathlib import Path

import pytest

from kurt2rt.channel.protocol.health_codec import report_of
from tests.cli.helpers import CommandLine, running


def test_status_by_file_and_over_the_channel_is_of_one_robot(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("run", "--page", "--page-port", "0", "--port", "0", "--knowledge", "mine.knowledge")
    with running(*words, folder=tmp_path) as robot:
        port = int(robot.wait_for("UDP port").split()[-1])
        link = robot.wait_for("/pair?token=").strip()
        robot.wait_for("stands and asks")
        robot.wait_for("RLAs |")
        monkeypatch.setenv("COLUMNS", "200")
        assert f"page      {link}" in kurt2rt("status", "mine.knowledge").out
        for elsewhere in (("mine.knowledge", "--json"), ("--device", "terminal", "--port", str(port))):
            assert "token" not in kurt2rt("status", *elsewhere).out  # the address of a page is for this user alone
        by_file = report_of(json.loads(kurt2rt("status", "mine.knowledge", "--json").out))
        over_the_channel = report_of(
            json.loads(kurt2rt("status", "--device", "terminal", "--port", str(port), "--json").out)
        )
        assert by_file.boot == over_the_channel.boot
        assert [each.of for each in over_the_channel.disks] == ["knowledge", "recordings"]


def test_an_address_is_for_the_channel_only(kurt2rt: CommandLine) -> None:
    assert "give --device" in kurt2rt.misused("status", "--robot", "127.0.0.1")
