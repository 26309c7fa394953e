"""`kurt2rt status` of a running robot program."""

import json
from pathlib import Path

import pytest

from kurt2rt.channel.protocol.health import HEALTH
from tests.cli.helpers import CommandLine, running


def test_status_is_read_next_to_the_knowledge_file(
    kurt2rt: CommandLine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    words = ("run", "--page", "--page-port", "0", "--port", "0", "--knowledge", "mine.knowledge")
    with running(*words, folder=tmp_path) as robot:
        link = robot.wait_for("/pair?token=").strip()
        robot.wait_for("stands and asks")
        robot.wait_for("RLAs |")
        monkeypatch.setenv("COLUMNS", "200")
        assert f"page      {link}" in kurt2rt("status", "mine.knowledge").out
        told = kurt2rt("status", "mine.knowledge", "--json").out
        assert "token" not in told  # the address of a page is for this user alone
        report = HEALTH.read(json.loads(told))
        assert report.task == "wall_following"
        assert [each.of for each in report.disks] == ["knowledge", "recordings"]
