"""Reports at 80 columns: they break no word of the wide report."""

from collections.abc import Callable
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console, RenderableType

from kurt2rt.checks.commission.checklist import STEPS
from kurt2rt.checks.commission.progress import Progress
from kurt2rt.checks.commission.report import print_report as print_commissioning
from kurt2rt.checks.doctor.check_result import CheckResult, CheckStatus, FindingCode
from kurt2rt.checks.doctor.report import print_report as print_doctor
from kurt2rt.cli.status import as_rich as health_as_rich
from kurt2rt.experiments.lockstep.report import render_curriculum, render_seeds
from kurt2rt.experiments.navigation.tables import all_tables as navigation_tables
from kurt2rt.experiments.paper.tables import drive_table, exam_table, knowledge_table, paper_targets_table
from kurt2rt.experiments.phases.tables import all_tables as phases_tables
from kurt2rt.experiments.route.tables import all_tables as route_tables
from kurt2rt.experiments.study.table import as_rich
from kurt2rt.platform.text_table import print_whole
from tests.cli.helpers import CommandLine
from tests.experiments.helpers import short_task
from tests.experiments.navigation.test_goals import settings
from tests.experiments.navigation.test_tables import GOOD
from tests.experiments.navigation.test_tables import robot as errands_robot
from tests.experiments.paper import test_tables as paper
from tests.experiments.phases.outcomes import study as phases_study
from tests.experiments.results import curriculum_result, exam_result, robot_of_seed
from tests.experiments.route.test_tables import outcome as route_outcome
from tests.experiments.route.test_tables import study as route_study
from tests.runs.replay.stored_runs import STORED
from tests.service.health.reports import ILL

WALLS = str(STORED / "walls.mcap")
DRIVES = [paper.robot(seed, 92, paper.drive("rooms-9007"), paper.drive("manhattan")) for seed in (100, 101)]
FOUND = [
    CheckResult(FindingCode.PRIORITY, CheckStatus.OK, {"limit": "unlimited " * 9, "capability": "without"}),
    CheckResult(
        FindingCode.FOLDER, CheckStatus.OK, {"folder": "/var/lib/kurt2rt/knowledge/of/this/robot"}, needed=True
    ),
]

Print = Callable[[Console], None]


def printing(*parts: RenderableType) -> Print:
    return lambda console: print_whole(console, *parts)


REPORTS: dict[str, Print] = {
    "doctor": lambda console: print_doctor(FOUND, console),
    "commission": lambda console: print_commissioning(Progress(name="x", base="kurt2", bus="can0"), STEPS, console),
    "status": printing(health_as_rich(ILL)),
    "exam": printing(render_curriculum(curriculum_result(7, 88, exam_result("rooms-9007", stuck=True)), short_task())),
    "lesson --seeds": printing(
        render_seeds([robot_of_seed(100, 80, exam_result("a"), exam_result("manhattan"))], short_task())
    ),
    "lesson errands": printing(*map(as_rich, navigation_tables([errands_robot(100, GOOD)], settings()))),
    "lesson route": printing(*map(as_rich, route_tables(route_study([route_outcome(100), route_outcome(101)])))),
    "phases": printing(*map(as_rich, phases_tables(phases_study(), ["Too few."]))),
    "paper": printing(
        *(
            as_rich(of([paper.summary_of("streets", DRIVES)], "streets"))
            for of in (paper_targets_table, knowledge_table, exam_table, drive_table)
        )
    ),
}


def require_whole(narrow: str, wide: str) -> None:
    """Every word of `wide` stands in `narrow`, and no line is longer than 80 cells unless it is one word."""
    shown = set(narrow.replace(": ", " ").split()) | set(narrow.split())
    lines = {word for word in wide.split() if set(word) == {"─"}}
    assert set(wide.split()) - lines - shown == set()
    for line in narrow.splitlines():
        assert cell_len(line) <= 80 or len(line.split()) == 1, line


@pytest.mark.parametrize(
    "words",
    [
        ("knowledge", "list", "."),
        ("knowledge", "lessons", "taught.knowledge"),
        ("knowledge", "show", "taught.knowledge", "--rla", "1"),
        ("knowledge", "diff", "taught.knowledge", "taught.knowledge"),
        ("pair", "--list"),
        ("why", WALLS, "--to", "30"),
        ("why", WALLS, "--at", "1"),
    ],
    ids=" ".join,
)
def test_commands_break_no_word_at_80_columns(
    kurt2rt: CommandLine, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, lessons: Path, words: tuple[str, ...]
) -> None:
    (tmp_path / "taught.knowledge").write_bytes(lessons.read_bytes())
    folder = tmp_path / "a_folder_with_a_rather_long_name" / "and_another_one_that_is_as_long"
    folder.mkdir(parents=True)
    kurt2rt("knowledge", "export", "taught.knowledge", "taught.zip")
    assert kurt2rt("knowledge", "import", "taught.zip", "--into", folder / "from-a-friend.knowledge").exit_code == 0
    kurt2rt("pair", "a-device-with-a-long-nam")
    wide = kurt2rt(*words)
    monkeypatch.setenv("COLUMNS", "80")
    narrow = kurt2rt(*words)
    assert (narrow.exit_code, wide.exit_code) == (0, 0), wide.err
    require_whole(narrow.out, wide.out)
