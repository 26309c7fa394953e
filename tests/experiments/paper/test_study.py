"""Paper study on the simulated robot: plan, results, figures and report."""

import base64
import html
from dataclasses import dataclass
from pathlib import Path

import pytest

from kurt2rt.experiments.paper.settings import Extent, load_paper
from kurt2rt.experiments.paper.study import PaperStudy, make_plan, read_study
from kurt2rt.experiments.paper.tables import SUCCESS_NOTE, reasons_not_to_judge, tell
from kurt2rt.experiments.study.table import Told
from tests.experiments.helpers import STAGE
from tests.experiments.study.here import carry_out, parts_in
from tests.experiments.study.page import Page

pytestmark = pytest.mark.deep  # what all look at takes seconds; tests/cli/test_paper.py is the quick story

EXTENT = Extent(most_teaching_s=4.0, most_exam_s=1.0, most_unseen=1, most_radii=1, most_robots=1, most_growth_s=4.0)
COMMAND = "kurt2rt study paper --seeds 100"


@dataclass(frozen=True)
class Tiny:
    """The smallest run with all kinds of results: too short to teach anything."""

    folder: Path
    study: PaperStudy
    told: Told
    text: str
    """Report."""


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Tiny:
    folder = tmp_path_factory.mktemp("paper")
    tasks = ("wall_following", "eight")
    plan = make_plan(load_paper(), EXTENT, (100,), ("shipped", "plain"), parts_in(folder), tasks=tasks)
    carry_out(plan, folder)
    told = tell(plan, STAGE, COMMAND)
    return Tiny(folder, read_study(plan), told, told.files["report"].read_text(encoding="utf-8"))


def test_the_report_holds_every_figure_and_every_table(tiny: Tiny) -> None:
    page = Page(tiny.text)
    pictures = [base64.b64decode(address.removeprefix("data:image/png;base64,")) for address in page.addresses]
    assert sorted(pictures) == sorted(path.read_bytes() for path in tiny.folder.glob("*.png"))
    titles = [table.title for table in tiny.told.tables]
    assert len(titles) == len(set(titles)) == 10
    assert all(f"<caption>{title}</caption>" in tiny.text for title in titles)
    assert page.tags.count("table") == len(titles) + 3  # generated worlds in both readings, and settings


def test_the_report_says_how_it_was_made_and_that_it_is_a_part(tiny: Tiny) -> None:
    for each in (f"<code>{COMMAND}</code>", "4 s", "numpy", "<code>kurt2rt knowledge show</code>"):
        assert each in tiny.text
    assert all(reason in tiny.text for reason in reasons_not_to_judge(tiny.study.plan))
    assert "MISSED" not in tiny.text  # seconds of teaching judge nothing


def test_report_lists_all_settings(tiny: Tiny) -> None:
    assert html.escape(SUCCESS_NOTE, quote=False).replace("'", "&#39;") in tiny.text
    for setting in ("learning.weights.1.features", "maximum front", "teaching.profile.name", "exam.stuck_within_m"):
        assert f"<td>{setting}</td>" in tiny.text
    assert "teaching.profile.person" not in tiny.text
