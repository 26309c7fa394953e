"""`kurt2rt run --robots`: several simulated robots for a class, each a program of its own, and one table of all."""

import math
import re
import signal
import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import urlsplit

import jinja2
import segno
from rich.console import Console, Group
from rich.live import Live
from rich.text import Text

from kurt2rt.channel.protocol.health import HealthReport
from kurt2rt.channel.protocol.health_text import name_of
from kurt2rt.channel.security.pairing import pair, pairing_names
from kurt2rt.channel.server.channel import EVERYWHERE
from kurt2rt.channel.server.endpoint import require_port
from kurt2rt.cli.terminal_screen import has_desktop, open_file, write_private
from kurt2rt.platform.durable_files import write_durably
from kurt2rt.platform.signal_handlers import SignalHandlers
from kurt2rt.platform.text_table import Column, TextTable, print_lines
from kurt2rt.service.child_processes import ChildProcesses
from kurt2rt.service.health.status_error import StatusError
from kurt2rt.service.health.status_socket import read_reports
from kurt2rt.service.settings import ServiceSettings
from kurt2rt.teacher.page.server import listen

_REFRESH_S = 1.0
_PATIENCE_S = 3.0
_HEADINGS = ("robot", "page", "teacher", "phase", "rules", "alone", "asks", "reached", "does")
_NUMBERS = frozenset({"phase", "rules", "alone", "asks", "reached"})
_NAME_CELLS = 8
_OTHER_CELLS = 64
"""Width of the table without its last column."""


@dataclass
class ClassRobot:
    """Robot of a class: its settings, and the newest report of its program."""

    number: int
    service: ServiceSettings
    report: HealthReport | None = None
    """None while no report comes."""
    last_line: str = ""
    """Last line that its program printed."""

    @property
    def name(self) -> str:
        """Name in messages."""
        return f"robot {self.number}"

    @property
    def settings_file(self) -> Path:
        """File of its runtime settings, in the folder of its keys, knowledge and recordings."""
        return Path(self.service.knowledge).with_name("settings.yaml")

    def start(self, programs: ChildProcesses, words: Sequence[str]) -> None:
        """Write its settings, pair its phone at the first start, start its program and follow its reports.

        `words`: further options of the command line. Raises the errors of `run_robots`.
        """
        service, device = self.service, f"group-{self.number}"
        require_port(EVERYWHERE, service.port)
        listen(service.page_port, everywhere=True).close()
        write_durably(self.settings_file, service.model_dump_json(indent=2))
        if device not in pairing_names(service.pairings.teachers):
            pair(*service.pairings, device, port=service.port)
        own = ("--settings", str(self.settings_file), "--page-port", str(service.page_port), *words)
        programs.start(self.name, "run", "--phone", "--no-open", *own, restarts=True, on_line=self._read_line)
        threading.Thread(target=self._follow, name=self.name, daemon=True).start()

    def _read_line(self, line: str) -> None:
        self.last_line = line

    def _follow(self) -> None:
        """Read the reports of its program, and of the next one, without end."""
        while True:
            # The status has the name of the knowledge file, which changes with the task.
            for path in self.settings_file.parent.glob("*.status"):
                with suppress(StatusError, OSError):
                    for self.report in read_reports(path, _PATIENCE_S):
                        continue
            self.report = None
            time.sleep(_REFRESH_S)


def class_robots(count: int, service: ServiceSettings) -> tuple[ClassRobot, ...]:
    """Return `count` robots with the task and world of `service`, in folders of their own in a folder `class`."""
    knowledge = Path(service.knowledge)

    def robot(number: int) -> ClassRobot:
        folder = knowledge.parent / "class" / f"robot-{number}"
        files = {"knowledge": knowledge.name, "teachers": "teachers", "devices": "devices", "recordings": "runs"}
        own: dict[str, object] = {key: str(folder / name) for key, name in files.items()}
        own |= {"port": service.port + number, "page_port": service.page_port + number}
        own["recordings_mb"] = max(10, service.recordings_mb // count)  # 10: the least that settings may have
        return ClassRobot(number, service.model_copy(update=own))

    return tuple(map(robot, range(1, count + 1)))


def run_robots(
    robots: Sequence[ClassRobot], words: Sequence[str], console: Console, *, browser: bool, seconds: float | None
) -> None:
    """Run the robots until a signal or the time ends all, with one table and one page of codes.

    Args:
        robots: of `class_robots`.
        words: further options of `kurt2rt run` for each robot.
        console: terminal of the table.
        browser: whether this desktop's browser opens the page.
        seconds: length of the run in s; None: until a signal.

    Raises:
        ChannelError, PageError: a port is in use.
        CredentialsError, OSError: a folder or file cannot be written, or no program can be started.
    """
    folder, ended = robots[0].settings_file.parents[1], threading.Event()
    ends_at_s = time.monotonic() + (math.inf if seconds is None else seconds)

    def log(text: str) -> None:
        # After an exit code, the last line is the error; after a signal, any line, perhaps with a secret link.
        last = [each.last_line for each in robots if text.startswith(f"{each.name} ended (exit")]
        print_lines(console, ": ".join([text, *last]), style="yellow")

    ends = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGQUIT)
    handlers = SignalHandlers(dict.fromkeys(ends, lambda *_: ended.set()))
    told: list[tuple[str, ...]] = []
    with handlers, Live(console=console, auto_refresh=False) as live, ChildProcesses(log=log) as programs:
        for each in robots:
            each.start(programs, words)
        while not ended.wait(_REFRESH_S) and time.monotonic() < ends_at_s:
            reports = [each.report for each in robots]  # its threads replace them at any time
            links = [() if each is None else each.pages for each in reports]
            if all(links) and links != told:
                write_private(folder / "robots.html", page_of_codes(links))
                if browser and not told and has_desktop():
                    open_file(folder / "robots.html")
                told = links
            live.update(Group(*_lines(robots, reports, console.width)), refresh=True)
    if not console.is_terminal:
        console.print()  # a pipe gets the last table without an end of its line
    files = f"{folder}/robot-*/*.knowledge"
    print_lines(console, f"all robots stand; to hand in: {files}", f"to examine all: kurt2rt exam {files}", whole=True)


def _lines(
    robots: Sequence[ClassRobot], reports: Sequence[HealthReport | None], width: int
) -> "Iterator[TextTable | Text]":
    table = TextTable(*(Column(each, number=each in _NUMBERS, whole=each not in _NUMBERS) for each in _HEADINGS))
    for each, report in zip(robots, reports, strict=True):
        own = str(each.number), f":{each.service.page_port}"
        table.add_row(*own, *(_cells(report, width) if report else (*[""] * 6, "starts")))
    yield table
    for each, report in zip(robots, reports, strict=True):
        if report is not None and report.troubles:
            names = ", ".join(dict.fromkeys(map(name_of, report.troubles)))
            yield Text(f"! {each.name}: {names}; kurt2rt status --settings {each.settings_file}", style="yellow")
    yield Text(f"codes to scan: {robots[0].settings_file.parents[1]}/robots.html; Ctrl-C ends all", style="dim")


def _cells(report: HealthReport, width: int) -> tuple[str | Text, ...]:
    percent, does = report.progress.driven_percent, Text(re.split(r",| at | by ", report.doing)[0])
    does.truncate(max(width - _OTHER_CELLS, _NAME_CELLS), overflow="ellipsis")
    teacher, alone = (report.teacher or "-")[:_NAME_CELLS], "" if percent is None else f"{percent} %"
    return teacher, str(report.phase), str(report.rlas), alone, str(report.progress.asks), report.reached, does


def page_of_codes(links: Sequence[Sequence[str]]) -> str:
    """Return an HTML page with the number of each robot, the code of its page for a phone, and a link for this machine.

    `links`: to the page of each robot, first this machine's. They hold tokens, so keep the page as a secret.
    """

    def card(number: int, of_robot: Sequence[str]) -> dict[str, object]:
        here, *phones = of_robot
        codes = [segno.make(each, error="m", micro=False).svg_inline(omitsize=True) for each in phones[:1]]
        return {"number": number, "here": here, "codes": codes, "place": urlsplit((phones or [here])[0]).netloc}

    template = jinja2.Environment(loader=jinja2.PackageLoader("kurt2rt.cli", ""), autoescape=True)
    return template.get_template("robots.html.j2").render(robots=map(card, range(1, len(links) + 1), links))
