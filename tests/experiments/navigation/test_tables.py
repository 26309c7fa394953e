"""Tables of the navigation study."""

import re

from kurt2rt.experiments.navigation.exam import GoalOutcome
from kurt2rt.experiments.navigation.study import ErrandsOutcome, all_tables
from tests.experiments.navigation.test_goals import settings
from tests.experiments.rows import MADE_OF, titled


def errand(why_not: str = "", *, collisions: int = 0, demonstrated: float | None = 3.0) -> GoalOutcome:
    return GoalOutcome(
        goal="place 7",
        why_not=why_not,
        seconds=30.0,
        way_m=8.1,
        shortest_m=9.0,
        junctions=5,
        demonstrated=demonstrated,
        surprises=0,
        collisions=collisions,
    )


def robot(seed: int, *errands: GoalOutcome) -> ErrandsOutcome:
    return ErrandsOutcome(
        made_of=MADE_OF,
        seed=seed,
        teaching_s=1165.0,
        ways=100,
        ways_in_all=104,
        mid_rlas=100,
        basic_rlas=150,
        mid_asks=48,
        missed_junctions=0,
        corrections=30,
        rescues=0,
        named={"home": (0.4, 1.3)},
        led=(),
        knowledge_hash="",
        errands=errands,
        trail=(),
    )


GOOD = [errand()] * 20


def test_robots_that_nobody_has_seen_before_are_judged() -> None:
    outcomes = [robot(seed, *GOOD) for seed in range(100, 118)]
    outcomes += [robot(seed, *[errand()] * 17, *[errand(why_not="no way")] * 3) for seed in (118, 119)]
    table = next(all_tables(outcomes, settings()))
    assert [row[3] for row in table.rows] == ["met"] * 3
    assert [row[1:3] for row in table.rows[:2]] == [("360 of 400", "394 of 400"), ("18 of 20", "18 of 20")]
    assert "1.3" in table.rows[2][1]
    assert table.rows[2][2] == "0.90"


def test_runs_table_lists_goals_and_demonstrations() -> None:
    table = titled(
        all_tables([robot(1, errand(demonstrated=None), errand(demonstrated=2.0))], settings(), "slow"), "Goals"
    )
    assert [row[0] for row in table.rows] == ["2 of 2"]
    assert re.findall(r"\d[\d.]*", table.note.split(":")[-1]) == ["2.0", "2.00", "1"]
    assert "slow" in table.note


def test_each_robot_tells_what_it_did_not_reach_and_why() -> None:
    table = titled(
        all_tables([robot(3, errand(), errand(why_not="time"), errand(collisions=2))], settings()), "Each robot"
    )
    assert table.rows[0][0] == "3"
    failed = [each.removeprefix("place 7: ") for each in table.rows[0][-1].split(", ")]
    assert failed[0] == "time"
    assert failed[1].startswith("2 ")
