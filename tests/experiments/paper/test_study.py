"""Paper study on the simulated robot: plan, results, figures and report."""

import base64
import html
import re
from dataclasses import dataclass
from pathlib import Path

import pytest
from matplotlib.image import imread

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.paper.figures import draw_figures
from kurt2rt.experiments.paper.settings import Extent, load_paper
from kurt2rt.experiments.paper.study import GrowthJob, PaperExtent, TaughtJob, make_plan
from kurt2rt.experiments.paper.tables import (
    SUCCESS,
    PaperStudy,
    all_tables,
    exams_table,
    learning_table,
    read_study,
    reasons_not_to_judge,
    write_paper,
)
from kurt2rt.experiments.study.figures import SavedFigure
from kurt2rt.experiments.study.study_plan import StudyPlan
from kurt2rt.knowledge.journal.loading import read_lessons
from tests.experiments.helpers import ROBOT, STAGE
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
    pictures: list[SavedFigure]
    text: str
    """Report."""


def tiny_plan(folder: Path, *tasks: str) -> StudyPlan[PaperExtent]:
    return make_plan(load_paper(), EXTENT, (100,), ("shipped", "plain"), parts_in(folder), tasks=tasks)


@pytest.fixture(scope="module")
def tiny(tmp_path_factory: pytest.TempPathFactory) -> Tiny:
    folder = tmp_path_factory.mktemp("paper")
    study = read_study(carry_out(tiny_plan(folder, "wall_following", "eight"), folder))
    pictures = list(draw_figures(study, STAGE, folder))
    report = folder / "report.html"
    write_paper(study, pictures, COMMAND, report)
    return Tiny(folder, study, pictures, report.read_text(encoding="utf-8"))


def test_each_robot_leaves_its_knowledge(tiny: Tiny) -> None:
    for each in tiny.study.experiments:
        (outcome,) = each.outcomes
        path = tiny.folder / f"knowledge/{each.of.reading}/{each.of.task.name}-100.knowledge"
        assert len(read_lessons(path, ROBOT, each.of.task)) >= outcome.lesson.rlas > 0
        assert all(len(drive.trail) == 5 for drive in outcome.drives)  # 1 s, 0.2 s from one to the next
    for job, each in zip(tiny.study.plan.of(TaughtJob), tiny.study.experiments, strict=True):
        assert tuple(drive.world for drive in each.outcomes[0].drives) == job.worlds
    growth = tiny.study.plan.of(GrowthJob)
    assert {job.radius for job in growth} == {load_task("wall_following").learning.radius}  # as it is shipped


def test_interrupted_run_completes_to_equal_bytes(tiny: Tiny, tmp_path: Path) -> None:
    plan = tiny_plan(tmp_path, "eight")
    first, second = (job.file for job in plan.jobs)
    (tmp_path / first).parent.mkdir(parents=True)
    (tmp_path / first).write_bytes((tiny.folder / first).read_bytes())
    stamp_ns = (tmp_path / first).stat().st_mtime_ns
    carry_out(plan, tmp_path)
    assert (tmp_path / first).stat().st_mtime_ns == stamp_ns
    assert (tmp_path / second).read_bytes() == (tiny.folder / second).read_bytes()


def test_every_figure_is_drawn_under_its_name(tiny: Tiny) -> None:
    assert [each.path.name for each in tiny.pictures] == [
        "fig2.png",
        "fig4.png",
        "fig6.png",
        "fig7.png",
        "drive-wall_following.png",
        "drive-eight.png",
    ]
    for each in tiny.pictures:
        height, width, _ = imread(each.path).shape
        assert min(height, width) > 500


def test_the_report_holds_every_figure_and_every_table(tiny: Tiny) -> None:
    page = Page(tiny.text)
    assert page.images == [each.title for each in tiny.pictures]
    pictures = [base64.b64decode(address.removeprefix("data:image/png;base64,")) for address in page.addresses]
    assert pictures == [each.path.read_bytes() for each in tiny.pictures]
    titles = [table.title for table in all_tables(tiny.study)]
    assert len(titles) == len(set(titles)) == 10
    assert all(f"<caption>{title}</caption>" in tiny.text for title in titles)
    assert page.tags.count("table") == len(titles) + 4  # generated worlds in both readings, and two of settings


def test_the_report_needs_nothing_but_itself(tiny: Tiny) -> None:
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", tiny.text)
    assert not [each for each in ("://", "url(", "<script", str(tiny.folder)) if each in text]


def test_the_report_says_how_it_was_made_and_that_it_is_a_part(tiny: Tiny) -> None:
    for each in (f"<code>{COMMAND}</code>", "4 s", "numpy", "<code>kurt2rt knowledge show</code>"):
        assert each in tiny.text
    assert all(reason in tiny.text for reason in reasons_not_to_judge(tiny.study.plan))
    assert "MISSED" not in tiny.text  # seconds of teaching judge nothing


def test_report_escapes_its_values(tiny: Tiny, tmp_path: Path) -> None:
    evil = [tiny.pictures[1]._replace(caption="<script>alert(1)</script>")]
    write_paper(tiny.study, evil, "kurt2rt study paper --task a<b", tmp_path / "report.html")
    text = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "<script" not in text
    assert "a&lt;b" in text


def test_report_lists_all_settings(tiny: Tiny) -> None:
    learning, exams = learning_table(tiny.study), exams_table(tiny.study)
    shipped, plain = (
        dict(zip(learning.columns, row, strict=True)) for row in learning.rows if row[0] == "wall following"
    )
    assert shipped["weights that are not 1"].startswith("1.5: s15; 2: maximum front; 0: minimum front; 0.5: s5, s6")
    assert plain["weights that are not 1"] == "none"
    assert {shipped["teacher"], plain["teacher"]} == {"ordinary"}
    eight = next(dict(zip(learning.columns, row, strict=True)) for row in learning.rows if row[0] == "eight")
    assert (eight["re-positions"], eight["sets it down at"]) == ("every 30 s", "a start pose")
    assert eight["rescues"] == "after 15 s within 1 m"
    assert [row[0] for row in exams.rows] == ["wall following", "eight"]
    assert exams.rows[1] == ("eight", "a start pose", "1", "20", "1", "0", "80%", "")
    assert all(f"<caption>{table.title}</caption>" in tiny.text for table in (learning, exams))
    assert html.escape(SUCCESS, quote=False).replace("'", "&#39;") in tiny.text
