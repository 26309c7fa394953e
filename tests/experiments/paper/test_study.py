"""Paper study on the simulated robot: plan, results, figures and report."""

import base64
import html
import re
from dataclasses import replace
from pathlib import Path

import pytest
from matplotlib.image import imread

from kurt2rt.core.task_settings import load_task
from kurt2rt.experiments.paper.eligibility import reasons_not_to_judge
from kurt2rt.experiments.paper.report import write_report
from kurt2rt.experiments.paper.settings_tables import SUCCESS, exams_table, learning_table
from kurt2rt.experiments.paper.tables import all_tables
from kurt2rt.experiments.study.plan import run_missing
from kurt2rt.experiments.study.results import Results
from kurt2rt.knowledge.journal.loading import read_lessons
from tests.experiments.helpers import ROBOT
from tests.experiments.paper.tiny import COMMAND, Tiny, tiny_plan
from tests.experiments.study.here import HERE
from tests.experiments.study.page import Page

pytestmark = pytest.mark.deep  # what all look at takes seconds; tests/cli/test_paper.py is the quick story


def test_each_job_leaves_its_result_and_each_robot_its_knowledge(tiny: Tiny) -> None:
    folder = tiny.results.folder
    assert tiny.results.missing(tiny.plan.jobs) == []
    assert not list(folder.glob("unfinished-*"))
    for experiment in tiny.plan.experiments:
        (job,) = experiment.jobs
        (outcome,) = next(
            each.outcomes for each in tiny.study.of(job.reading) if each.task.name == experiment.task.name
        )
        lessons = read_lessons(folder / f"knowledge/{job.reading}/{job.task.name}-100.knowledge", ROBOT, job.task)
        assert len(lessons) >= outcome.rlas > 0
        assert [drive.world for drive in outcome.drives] == [*job.task.exam.worlds, *job.unseen]
        assert all(len(drive.trail) == 5 for drive in outcome.drives)  # 1 s, 0.2 s from one to the next
    growth = tiny.plan.growth[0].jobs
    assert {job.radius for job in growth} == {load_task("wall_following").learning.radius}  # as it is shipped


def test_interrupted_run_completes_to_equal_bytes(tiny: Tiny, tmp_path: Path) -> None:
    results = Results(tmp_path)
    plan = tiny_plan(results, "eight")
    first, second = (job.file for job in plan.jobs)
    (tmp_path / first).parent.mkdir(parents=True)
    (tmp_path / first).write_bytes((tiny.results.folder / first).read_bytes())
    stamp_ns = (tmp_path / first).stat().st_mtime_ns

    run_missing(plan, results, HERE, lambda _: None)
    assert (tmp_path / first).stat().st_mtime_ns == stamp_ns
    assert (tmp_path / second).read_bytes() == (tiny.results.folder / second).read_bytes()
    assert results.missing(plan.jobs) == []


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
    text = tiny.report.read_text(encoding="utf-8")
    page = Page(text)
    assert page.images == [each.title for each in tiny.pictures]
    pictures = [base64.b64decode(address.removeprefix("data:image/png;base64,")) for address in page.addresses]
    assert pictures == [each.path.read_bytes() for each in tiny.pictures]
    titles = [table.title for table in all_tables(tiny.study)]
    assert len(titles) == len(set(titles)) == 10
    assert all(f"<caption>{title}</caption>" in text for title in titles)
    assert page.tags.count("table") == len(titles) + 4  # generated worlds in both readings, and two of settings


def test_the_report_needs_nothing_but_itself(tiny: Tiny) -> None:
    text = re.sub(r"data:image/png;base64,[A-Za-z0-9+/=]+", "", tiny.report.read_text(encoding="utf-8"))
    assert "://" not in text
    assert "url(" not in text
    assert "<script" not in text
    assert str(tiny.results.folder) not in text


def test_the_report_says_how_it_was_made_and_that_it_is_a_part(tiny: Tiny) -> None:
    text = tiny.report.read_text(encoding="utf-8")
    assert f"<code>{COMMAND}</code>" in text
    assert "4 s" in text
    assert all(reason in text for reason in reasons_not_to_judge(tiny.plan))
    assert "numpy" in text
    assert "MISSED" not in text  # seconds of teaching judge nothing


def test_report_escapes_its_values(tiny: Tiny, tmp_path: Path) -> None:
    evil = [replace(tiny.pictures[1], caption="<script>alert(1)</script>")]
    report = tmp_path / "report.html"
    write_report(tiny.study, evil, "kurt2rt paper --task a<b", report)
    text = report.read_text(encoding="utf-8")
    assert "<script" not in text
    assert "a&lt;b" in text


@pytest.mark.parametrize("how", ["", "Plain reading: "], ids=["shipped", "plain"])
def test_both_readings_have_their_tables(tiny: Tiny, how: str) -> None:
    titles = {table.title.lower() for table in all_tables(tiny.study)}
    for what in ("what was asked", "what was taught", "exams without teacher", "drives of these exams"):
        assert (how + what).lower() in titles


def test_report_lists_all_settings(tiny: Tiny) -> None:
    learning, exams = learning_table(tiny.study), exams_table(tiny.study)
    shipped, plain = (
        dict(zip(learning.columns, row, strict=True)) for row in learning.rows if row[0] == "wall following"
    )
    assert shipped["weights that are not 1"].startswith("1.5: s15; 2: maximum front; 0: minimum front; 0.5: s5, s6")
    assert plain["weights that are not 1"] == "none"
    assert {shipped["teacher"], plain["teacher"]} == {load_task("wall_following").teaching.default_teacher}
    eight = next(dict(zip(learning.columns, row, strict=True)) for row in learning.rows if row[0] == "eight")
    assert (eight["re-positions"], eight["sets it down at"]) == ("every 30 s", "a start pose")
    assert eight["rescues"] == "after 15 s within 1 m"
    assert [row[0] for row in exams.rows] == ["wall following", "eight"]
    assert exams.rows[1] == ("eight", "a start pose", "1", "20", "1", "0", "80%", "")
    text = tiny.report.read_text(encoding="utf-8")
    assert all(f"<caption>{table.title}</caption>" in text for table in (learning, exams))
    assert html.escape(SUCCESS, quote=False).replace("'", "&#39;") in text
    assert all(
        SUCCESS in table.note for table in all_tables(tiny.study) if "exams without teacher" in table.title.lower()
    )
