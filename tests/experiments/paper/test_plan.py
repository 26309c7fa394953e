"""Plan of the paper study."""

from collections import Counter
from pathlib import Path
from typing import Any

import pytest
import yaml

from config import CONFIG_DIR
from hal.settings import SettingsError
from kurt2rt.core.task_settings import load_task, taught_by
from kurt2rt.core.teacher_settings import load_teacher
from kurt2rt.experiments.paper.extent import QUICK, WHOLE, Extent
from kurt2rt.experiments.paper.outcome import Reading
from kurt2rt.experiments.paper.plan import PaperPlan, make_plan, unseen_of
from kurt2rt.experiments.paper.settings import PaperSettings, load_paper
from kurt2rt.experiments.study.jobs import JobParts
from kurt2rt.experiments.study.results import Results, StudyError
from tests.experiments.helpers import ROBOT, STAGE

ISSUE = {  # RLAs at most, success at least by world, of generated worlds
    "fleeing": (67, {"a": 0.9, "b": 0.8, "c": 0.8}, None),
    "wall_following": (91, {"a": 0.95, "b": 0.9, "c": 0.9}, 0.9),
    "circle": (35, {"one_object": 0.9}, None),
    "circle_repositioned": (35, {"one_object": 0.9}, None),
    "eight": (122, {"two_objects": 0.95}, None),
}


def planned(
    *tasks: str,
    extent: Extent = WHOLE,
    seeds: tuple[int, ...] = (100, 101, 102),
    readings: tuple[Reading, ...] = ("shipped",),
    paper: PaperSettings | None = None,
) -> PaperPlan:
    return make_plan(
        paper or load_paper(),
        extent,
        seeds,
        readings,
        JobParts(factory=STAGE, robot=ROBOT, results=Results(Path("never-made"))),
        tasks=tasks,
    )


def changed_task(folder: Path, **keys: Any) -> str:
    content = yaml.safe_load((CONFIG_DIR / "tasks" / "circle.yaml").read_text())
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content | keys))
    return str(path)


def test_the_shipped_experiments_ask_what_was_asked() -> None:
    asked = {each.task: each for each in load_paper().experiments}
    for task, (rlas, success, unseen) in ISSUE.items():
        assert asked[task].asked.rlas_at_most == rlas
        assert asked[task].asked.success_at_least == success
        settings = asked[task].unseen
        assert (settings.success_at_least if settings else None) == unseen
    assert asked["streets"].asked.right_at_least == 0.95
    assert asked["streets"].asked.collisions_below_per_10_min == 0.5
    assert asked["streets"].asked.rlas_at_most == 135
    assert sum(asked["streets"].paper_rlas_of.values()) == 135


def test_everything_that_is_shipped_can_be_planned() -> None:
    plan = planned(readings=("shipped", "plain"), seeds=(100,), extent=Extent(most_unseen=1))
    tasks = [each.task for each in load_paper().experiments]
    for reading in ("shipped", "plain"):
        assert [each.task.name for each in plan.experiments if each.reading == reading] == tasks
    assert len({job.file for job in plan.jobs}) == len(plan.jobs)


WALL_FOLLOWING = next(each for each in load_paper().experiments if each.task == "wall_following")


@pytest.mark.parametrize("first", [100, 113])
def test_twenty_robots_share_all_generated_worlds(first: int) -> None:
    drives = Counter(world for seed in range(first, first + 20) for world in unseen_of(seed, WALL_FOLLOWING))
    assert drives == {f"rooms-{number}": 1 for number in range(100, 130)}


def test_more_robots_may_be_added_to_those_there_are() -> None:
    extent = Extent(most_unseen=3)
    (few,) = planned("wall_following", extent=extent, seeds=(100, 101)).experiments
    (more,) = planned("wall_following", extent=extent, seeds=(102, 101, 100)).experiments
    assert {job.seed: job.unseen for job in few.jobs} == {100: ("rooms-100",), 101: ("rooms-101",)}
    assert {(job.file, job.made_of) for job in few.jobs} < {(job.file, job.made_of) for job in more.jobs}


def test_fig_2_is_drawn_where_its_task_is_taught() -> None:
    (growth,) = planned("wall_following", extent=Extent(most_unseen=1, most_robots=2)).growth
    assert [(job.radius, job.seed) for job in growth.jobs][:3] == [(150.0, 100), (150.0, 101), (200.0, 100)]
    assert all(job.task.teaching.corrections_s == 0.0 and job.robot_time_s == 600.0 for job in growth.jobs)
    assert planned("circle").growth == ()


def test_the_plain_reading_has_the_settings_of_its_own() -> None:
    shipped, plain = planned("circle", readings=("shipped", "plain")).experiments
    ordinary = load_teacher("ordinary")
    assert shipped.task == taught_by(load_task("circle"), ordinary)
    assert plain.task == taught_by(load_task("circle", plain=True), ordinary)
    assert plain.jobs[0].made_of.differences(shipped.jobs[0].made_of) == ["task"]


def test_a_part_shortens_times_and_nothing_of_learning() -> None:
    (experiment,) = planned("eight", extent=QUICK).experiments
    whole = load_task("eight")
    assert experiment.task.learning == taught_by(whole, load_teacher(whole.teaching.default_teacher)).learning
    assert experiment.task.teaching.duration_s == pytest.approx(60.0, abs=1.0)
    share = whole.teaching.supervised_s / whole.teaching.duration_s
    assert experiment.task.teaching.supervised_s == pytest.approx(60.0 * share, abs=1.0)
    assert experiment.task.exam.duration_s == 20.0


def test_a_task_of_ones_own_is_done_and_nothing_is_asked_of_it(tmp_path: Path) -> None:
    (experiment,) = planned(changed_task(tmp_path, name="mine")).experiments
    assert experiment.task.name == "mine"
    assert experiment.settings.asked.rlas_at_most == 0


def test_an_unknown_task_is_refused_with_those_there_are() -> None:
    with pytest.raises(SettingsError, match=r"sledging: .* circle, .*streets"):
        planned("circle", "sledging")


def test_an_unknown_world_is_refused(tmp_path: Path) -> None:
    teaching = yaml.safe_load((CONFIG_DIR / "tasks" / "circle.yaml").read_text())["teaching"]
    with pytest.raises(SettingsError, match=r"nowhere: .*worlds"):
        planned(changed_task(tmp_path, name="mine", teaching=teaching | {"world": "nowhere"}))


@pytest.mark.parametrize("path", ["circle.yaml", "../tasks/circle.yaml"])
def test_a_path_to_a_shipped_task_is_the_same_as_its_name(path: str) -> None:
    (by_path,) = planned(str(CONFIG_DIR / "tasks" / path), "circle").experiments
    (by_name,) = planned("circle").experiments
    assert by_path.settings == by_name.settings
    assert [(job.file, job.made_of) for job in by_path.jobs] == [(job.file, job.made_of) for job in by_name.jobs]


def test_a_world_that_cannot_give_the_course_is_refused(tmp_path: Path) -> None:
    exam = yaml.safe_load((CONFIG_DIR / "tasks" / "circle.yaml").read_text())["exam"]
    with pytest.raises(SettingsError, match=r"mine: .*rounds: .*\bC .*\b0\b"):
        planned(changed_task(tmp_path, name="mine", exam=exam | {"worlds": ["one_object", "c"]}))


def test_two_tasks_of_one_name_are_refused(tmp_path: Path) -> None:
    with pytest.raises(StudyError, match=r"\bcircle\b"):
        planned("circle", changed_task(tmp_path))


def test_success_asked_in_a_world_without_exam_is_refused() -> None:
    paper = load_paper()
    circle = next(each for each in paper.experiments if each.task == "circle")
    asked = circle.asked.model_copy(update={"success_at_least": {"b": 0.5}})
    wrong = paper.model_copy(update={"experiments": (circle.model_copy(update={"asked": asked}),)})
    with pytest.raises(StudyError, match=r"circle: .*\bb\b.*one_object"):
        planned(paper=wrong)


def test_make_plan_teacher_of_the_paper_teaches_every_task() -> None:
    plan = planned("circle", "eight", paper=load_paper().model_copy(update={"teacher": "slow"}))
    assert {each.task.teaching.profile.name for each in plan.experiments} == {"slow"}
    quick, slow = planned("circle").jobs[0].made_of, plan.jobs[0].made_of
    assert slow is not None
    assert slow != quick


def test_make_plan_without_a_teacher_takes_that_of_each_task() -> None:
    plan = planned("circle", "streets")
    assert [each.task.teaching.profile.name for each in plan.experiments] == [
        load_task(name).teaching.default_teacher for name in ("circle", "streets")
    ]
