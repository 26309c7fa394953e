"""`kurt2rt sim` as a school robot at a pseudo-terminal, and a driver in another program at its other end."""

import time
from pathlib import Path

from kurt2rt.robots.school.kind import SCHOOL
from tests.cli.helpers import started
from tests.patience import PATIENCE_S
from tests.robots.school.rig import FORWARD, SETTINGS


def test_sim_is_a_school_robot_for_another_program(tmp_path: Path) -> None:
    device = tmp_path / "robot"
    words = ("sim", "--robot-settings", "school", "--world", "school/a", "--bus", str(device), "--while-stdin")
    with started("kurt2rt.cli.main", *words, folder=tmp_path) as simulator:
        ends_s = time.monotonic() + PATIENCE_S
        while not device.exists() and time.monotonic() < ends_s:
            time.sleep(0.02)
        robot = SCHOOL.open(SETTINGS, str(device))
        turned, ends_s = 0, time.monotonic() + PATIENCE_S
        while turned < 200 and time.monotonic() < ends_s:
            now_s = time.monotonic()
            turned += robot.sense(now_s).encoder_left_ticks
            robot.drive(FORWARD, now_s, now_s)
            time.sleep(0.01)
        robot.close()
        said, complaints = simulator.communicate()
    assert turned >= 200
    assert complaints == ""
    assert f"is on pseudo-terminal {device}" in said.replace("\n", " ")
    assert not device.exists()
