"""Plan of the paper study."""

import re
from collections import Counter
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from config import CONFIG_DIR
from config.settings import SettingsError
from kurt2rt.experiments.paper.settings import QUICK, WHOLE, ExperimentSettings, Extent, PaperSettings, load_paper
from kurt2rt.experiments.paper.study import GrowthJob, PaperExtent, TaughtJob, make_plan, unseen_of
from kurt2rt.experiments.paper.tables import reasons_not_to_judge
from kurt2rt.experiments.study.jobs import StudyError
from kurt2rt.experiments.study.study_plan import StudyPlan
from tests.experiments.helpers import STAGE
from tests.experiments.study.here import parts_in


def planned(
    *tasks: str, extent: Extent = WHOLE, seeds: tuple[int, ...] = (100, 101, 102), paper: PaperSettings | None = None
) -> StudyPlan[PaperExtent]:
    return make_plan(paper or load_paper(), extent, seeds, ["shipped"], parts_in(), tasks=tasks)


def first_of(plan: StudyPlan[PaperExtent]) -> TaughtJob:
    return plan.of(TaughtJob)[0]


def changed_task(folder: Path, **keys: Any) -> str:
    content = yaml.safe_load((CONFIG_DIR / "tasks" / "circle.yaml").read_text())
    path = folder / "mine.yaml"
    path.write_text(yaml.safe_dump(content | keys))
    return str(path)


WALL_FOLLOWING = next(each for each in load_paper().experiments if each.task == "wall_following")


@pytest.mark.parametrize("first", [100, 113])
def test_twenty_robots_share_all_generated_worlds(first: int) -> None:
    drives = Counter(world for seed in range(first, first + 20) for world in unseen_of(seed, WALL_FOLLOWING))
    assert drives == {f"rooms-{number}": 1 for number in range(100, 130)}


def test_fig_2_is_drawn_where_its_task_is_taught() -> None:
    growth = planned("wall_following", extent=Extent(most_unseen=1, most_robots=2)).of(GrowthJob)
    assert [(job.radius, job.seed) for job in growth][:3] == [(150.0, 100), (150.0, 101), (200.0, 100)]
    assert all(job.task.teaching.corrections_s == 0.0 and job.robot_time_s == 600.0 for job in growth)
    assert planned("circle").of(GrowthJob) == ()


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


NOT_SEEN = range(100, 120)


def judged(plan: StudyPlan[PaperExtent], seeds: range, settings: ExperimentSettings = WALL_FOLLOWING) -> list[str]:
    """Return the reasons not to judge a plan of one experiment with these seeds."""
    one = first_of(plan)
    jobs = tuple(replace(one, seed=seed, settings=settings, worlds=unseen_of(seed, settings)) for seed in seeds)
    return list(reasons_not_to_judge(replace(plan, seeds=tuple(seeds), jobs=jobs)))


def test_reasons_not_to_judge_are_seeds_rooms_and_a_part() -> None:
    plan = planned("wall_following", seeds=(100,))
    assert judged(plan, NOT_SEEN) == []
    (reason,) = judged(plan, range(100, 119))
    assert re.findall(r"\d+", reason) == ["19", "20"]
    (reason,) = judged(plan, range(100, 140, 2))
    assert re.findall(r"\d+", reason) == ["15", "30", "20"]
    (reason,) = judged(replace(plan, about=plan.about._replace(extent=QUICK)), NOT_SEEN)
    assert re.findall(r"\d+", reason) == ["60", "20"]
    assert WALL_FOLLOWING.unseen is not None
    known = WALL_FOLLOWING.model_copy(update={"unseen": WALL_FOLLOWING.unseen.model_copy(update={"first": 59})})
    (reason,) = judged(plan, NOT_SEEN, known)
    assert re.findall(r"rooms-\d+", reason) == ["rooms-0", "rooms-59"]


SHIPPED = yaml.safe_load((CONFIG_DIR / "paper" / "basic_level.yaml").read_text())


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"growth": SHIPPED["growth"] | {"task": "sledging"}}, r"growth\.task: .*'sledging'"),
        ({"eight": "nine"}, "eight: .*'nine'; .*: fleeing, "),
        ({"testing_ground": "nowhere"}, "testing_ground: nowhere: "),
        ({"worlds": ["a", "nowhere"]}, r"worlds\.1: nowhere: "),
    ],
)
def test_load_paper_names_file_and_key_of_missing_parts(changed: dict[str, Any], said: str, tmp_path: Path) -> None:
    path = tmp_path / "mine.yaml"
    path.write_text(yaml.safe_dump(SHIPPED | changed))
    with pytest.raises(SettingsError, match=f"^{re.escape(str(path))}: {said}"):
        load_paper(str(path), STAGE)
