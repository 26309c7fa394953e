"""Junk by the thousand a second: the robot's memory does not grow, its teacher keeps control, a stop gets through."""

import json
import re
import signal
import time
from pathlib import Path

import anyio
import pytest
import yaml

from kurt2rt.channel.security.pairing import local_pairing
from kurt2rt.teacher import TeacherClient
from tests.channel.robot_at_work import robot_at_work, service_settings
from tests.cli.helpers import ROOT, running

_CALM_S, _FLOOD_S = 5.0, 60
_MOST_GROWTH_KB = 20 * 1024
_STOP_WITHIN_S = 1.0
"""Ten times what a stop took at most on a machine with two busy cores."""
_STOPS = 16
_JUNK, _TEACHER = "tests.channel.junk_process", "tests.channel.teacher_process"


def _resident_kb(process: int) -> int:
    """Memory of a process, by its id."""
    status = Path(f"/proc/{process}/status").read_text(encoding="utf-8")
    return int(status.split("VmRSS:")[1].split()[0])


@pytest.mark.deep
def test_a_minute_of_junk_at_the_simulated_robot(tmp_path: Path) -> None:
    device = local_pairing(tmp_path / "teachers", tmp_path / "devices").device
    settings = tmp_path / "flood.yaml"
    settings.write_text(yaml.safe_dump(service_settings(tmp_path).model_dump()), encoding="utf-8")
    wide = {"COLUMNS": "300"}
    with running("run", "--settings", str(settings), folder=tmp_path, environment=wide, fresh=True) as robot:
        found = re.search(r"UDP port (\d+)", robot.wait_for("UDP port"))
        assert found is not None
        with running(str(device.folder), found[1], module=_TEACHER, folder=ROOT) as teacher:
            teacher.wait_for("teaching")
            time.sleep(_CALM_S)
            resident_kb = [_resident_kb(robot.process.pid)]
            with running(found[1], "2000", "", module=_JUNK, folder=ROOT):
                for _ in range(_FLOOD_S):
                    time.sleep(1.0)
                    resident_kb.append(_resident_kb(robot.process.pid))
            said = json.loads(teacher.end(signal.SIGTERM).out.splitlines()[-1])
    told = said["told"]
    assert told["accepted"] > 0
    assert told.get("no answer", 0) <= 0.01 * sum(told.values())
    assert said["pictures"] > 0
    assert max(resident_kb) - resident_kb[0] < _MOST_GROWTH_KB


@pytest.mark.deep
@pytest.mark.parametrize("copies_key_id", [False, True])
@pytest.mark.parametrize("per_s", [4_000, 10_000])
async def test_every_stop_from_a_fresh_socket_gets_through(tmp_path: Path, per_s: int, copies_key_id: bool) -> None:
    async with robot_at_work(tmp_path) as at_work:
        pairing, port, endpoint = at_work.pairing, at_work.port, at_work.channel.endpoint
        settings = json.loads((pairing.teacher / "settings.json").read_text(encoding="utf-8"))
        key_id = settings["recipient-id_hex"] if copies_key_id else ""
        with running(str(port), str(per_s), key_id, module=_JUNK, folder=ROOT) as junk:
            await anyio.to_thread.run_sync(junk.wait_for, "flooding")
            await anyio.sleep(0.5)
            for _ in range(_STOPS):
                async with TeacherClient(pairing.device.folder, port=port, patience_s=_STOP_WITHIN_S) as device:
                    await device.stop()
        assert endpoint.counters.received > 1000
        assert (endpoint.counters.failed, at_work.channel.failures) == (0, 0), endpoint.newest_failure
