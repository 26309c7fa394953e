"""`kurt2rt run --robots`: several robots for a class, with fake programs, and once with two real ones."""

import io
import os
import re
import signal
import stat
import sys
import time
from dataclasses import replace
from functools import partial
from itertools import cycle
from pathlib import Path

import pytest
import segno
from rich.console import Console

from kurt2rt.channel.security.pairing import pairing_names
from kurt2rt.cli import robots
from kurt2rt.cli.robots import class_robots, page_of_codes, run_robots
from kurt2rt.core.progress import Progress
from kurt2rt.platform.text_table import TextTable
from kurt2rt.service.child_processes import ChildProcesses
from kurt2rt.service.settings import ServiceSettings, load_service
from kurt2rt.teacher.page.public_address import PageError
from kurt2rt.teacher.page.server import listen
from tests.cli.helpers import CommandLine, running
from tests.cli.test_run import actions_in
from tests.service.health.reports import ILL, WELL

FAILS_ONCE = """
import os, signal, sys
from pathlib import Path
if not Path("failed").exists():
    Path("failed").touch()
    print("kurt2rt: no room;", *sys.argv[1:])
    sys.exit(3)
os.kill(os.getppid(), signal.SIGTERM)
sys.stdin.read()
"""
PATIENCE_S = 60.0
HERE, PHONE = "http://127.0.0.1:8644/pair?token=here", "http://192.168.0.7:8644/pair?token=phone"


def settings_with_free_ports() -> ServiceSettings:
    """Return settings with ports above which two more were free a moment ago."""
    for port in range(20_000 + os.getpid() % 10_000, 60_000, 3):
        try:
            for each in (port + 1, port + 2):
                listen(each, everywhere=True).close()
        except PageError:
            continue
        return load_service().model_copy(update={"port": port, "page_port": port})
    raise AssertionError("no port is free")


def test_options_of_one_robot_are_refused_for_several(kurt2rt: CommandLine) -> None:
    line = kurt2rt.misused("run", "--robots", "2", "--bus", "can0", "--can-log", "frames.log")
    assert "--bus, --can-log" in line
    assert "--robots" in kurt2rt.misused("run", "--robots", "9")
    assert "--service" in kurt2rt.misused("run", "--robots", "2", "--service")


def test_unknown_world_is_refused_before_a_robot_starts(kurt2rt: CommandLine, tmp_path: Path) -> None:
    assert "nowhere" in kurt2rt.refused("run", "--robots", "2", "--world", "nowhere")
    assert not (tmp_path / "var").exists()


def test_robot_that_ends_is_restarted_with_its_own_settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    programs = partial(ChildProcesses, start=(sys.executable, "-c", FAILS_ONCE), poll_s=0.01)
    monkeypatch.setattr(robots, "ChildProcesses", programs)
    ours = class_robots(2, settings_with_free_ports())
    printed = io.StringIO()
    run_robots(ours[:1], ("--seed", "7"), Console(file=printed, width=80), browser=False, seconds=None)
    told = printed.getvalue()
    file, port = "var/class/robot-1/settings.yaml", ours[0].service.page_port
    assert "robot 1 ended (exit code 3); it is started again" in told
    assert f"kurt2rt: no room; run --phone --no-open --settings {file} --page-port {port} --seed 7" in told
    assert "kurt2rt exam var/class/robot-*/*.knowledge" in told
    assert load_service(str(tmp_path / file)) == ours[0].service
    assert pairing_names(Path(ours[0].service.teachers)) == ("group-1",)
    assert [each.service.knowledge for each in ours] == [
        f"var/class/robot-{n}/wall_following.knowledge" for n in (1, 2)
    ]


def test_report_that_ends_meanwhile_ends_no_class(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    waits = (sys.executable, "-c", "import sys; sys.stdin.read()")
    monkeypatch.setattr(robots, "ChildProcesses", partial(ChildProcesses, start=waits))
    monkeypatch.setattr(robots, "_REFRESH_S", 0.01)
    reports = cycle([replace(WELL, pages=(HERE,)), None])
    monkeypatch.setattr(robots.ClassRobot, "report", property(lambda _: next(reports), lambda *_: None))
    console = Console(file=io.StringIO(), width=80)
    run_robots(class_robots(2, settings_with_free_ports())[:1], (), console, browser=False, seconds=0.2)
    assert HERE in (tmp_path / "var/class/robots.html").read_text("utf-8")


def test_table_of_all_robots_fits_80_columns() -> None:
    one, two = class_robots(2, load_service())
    report = replace(
        ILL, teacher="a-long-name-of-a-device", phase=2, reached="10.5 rounds", progress=Progress(60, 100, 12)
    )
    table, trouble, hint = robots._lines((one, two), (report, None), 80)
    assert isinstance(table, TextTable)
    first, second = [line.plain for line in table.lines(80)][2:]
    assert " ".join(first.split()) == "1 :8643 a-long-n 2 90 100 % 12 10.5 rounds stands: blind"
    assert " ".join(second.split()) == "2 :8644 starts"
    assert max(len(line.plain) for line in table.lines(80)) <= 80
    assert str(trouble).startswith("! robot 1: sensors silent, ticks missed; kurt2rt status --settings var/class/")
    assert "var/class/robots.html" in str(hint)


def test_page_has_the_code_of_each_phone_page() -> None:
    page = page_of_codes([(HERE, PHONE), (HERE,)])
    (path,) = re.findall(r'<path[^>]* d="[^"]*"', page)
    assert path in segno.make(PHONE, error="m", micro=False).svg_inline(omitsize=True)
    assert "192.168.0.7:8644" in page
    assert page.count("no network") == 1


def test_two_real_robots_learn_apart_and_end_together(tmp_path: Path, kurt2rt: CommandLine) -> None:
    (tmp_path / "class.yaml").write_text(settings_with_free_ports().model_dump_json(), encoding="utf-8")
    words = ("run", "--robots", "2", "--settings", "class.yaml", "--no-open", "--no-record")
    codes = tmp_path / "var/class/robots.html"
    with running(*words, folder=tmp_path) as robots_of_class:
        ends_s = time.monotonic() + PATIENCE_S
        while not codes.exists():
            assert time.monotonic() < ends_s
            time.sleep(0.05)
        assert stat.S_IMODE(codes.stat().st_mode) == 0o600
        assert "UDP port" in kurt2rt.refused(*words)
        second = ("teach", "--terminal", "--settings", "var/class/robot-2/settings.yaml")
        with running(*second, folder=tmp_path) as person:
            person.ask("stand", "RLA 1 taught: stand")
        said = robots_of_class.end(signal.SIGINT)
    assert (said.exit_code, said.err) == (0, "")
    first, taught = (tmp_path / f"var/class/robot-{n}/wall_following.knowledge" for n in (1, 2))
    assert (actions_in(first), actions_in(taught)) == ([], ["stand"])
    assert "all robots stand" in said.out
