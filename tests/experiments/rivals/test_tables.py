from dataclasses import replace
from pathlib import Path

from matplotlib.image import imread

from kurt2rt.experiments.rivals.claims import claim_table, hands_table
from kurt2rt.experiments.rivals.leagues import TITLES, LeagueName, rows_of_league
from kurt2rt.experiments.rivals.leagues import league_of as league_of_rival
from kurt2rt.experiments.rivals.outcome import RivalOutcome
from kurt2rt.experiments.rivals.report import write_report
from kurt2rt.experiments.rivals.rival import SHIPPED, Rival
from kurt2rt.experiments.rivals.sections import make_sections, overview_table, overview_tables, report_name
from kurt2rt.experiments.rivals.tables import (
    all_tables,
    comparison_table,
    effort_table,
    machine_table,
    success_table,
)
from kurt2rt.experiments.study.results import Results
from tests.experiments.rivals.outcomes import league_of, robot

OURS = (robot(1, "stuck", "right", "right"), robot(2, "stuck", "stuck", "right"), robot(3, *["not judged"] * 3))
THEIRS = (
    robot(1, "right", "right", "stuck", collisions=2),
    robot(2, "stuck", "stuck", "stuck", failure="1-nn: ValueError: empty"),
    robot(3, "right", "right", "right", collisions=1),
)


def test_success_counts_judged_robots_by_presses(tmp_path: Path) -> None:
    table = success_table(league_of(Results(tmp_path), OURS, THEIRS))
    assert table.columns == ("task", "learner", "after 2", "after 5", "at the end", "mean")
    ours, theirs = table.rows
    assert ours[:2] == ("wall_following", "RLA, as shipped")
    assert [cell.partition(" (")[0] for cell in ours[2:5]] == ["0 of 2", "1 of 2", "2 of 2"]
    assert ours[5] == "50%"
    assert [cell.partition(" (")[0] for cell in theirs[2:5]] == ["2 of 3", "2 of 3", "1 of 3"]
    assert "with the defaults of their classes: 1-NN without R" in table.note


def test_claim_is_refuted_by_a_learner_that_comes_close(tmp_path: Path) -> None:
    results = Results(tmp_path)
    right, stuck = (tuple(robot(seed, *[end] * 3) for seed in range(1, 11)) for end in ("right", "stuck"))
    claims = [claim_table(league_of(results, right, (*right[:passed], *stuck[passed:]))).rows[0] for passed in (9, 8)]
    assert [(claim[0], claim[2], *claim[4:]) for claim in claims] == [
        ("wall_following", "1-NN without R", "0.90", "refuted"),
        ("wall_following", "1-NN without R", "0.80", "stands"),
    ]
    assert claim_table(league_of(results, stuck, stuck)).rows[0][4:] == ("-", "not judged")


def test_claim_counts_no_variant_of_the_rla_system(tmp_path: Path) -> None:
    league = league_of(Results(tmp_path), OURS, THEIRS)
    ours, theirs = league.rows
    variant = replace(theirs, entry=replace(theirs.entry, rival=Rival("rla-vote")))
    own = replace(league, rows=(ours, variant))
    assert claim_table(own).rows == ()
    assert len(list(all_tables(own))) == len(list(all_tables(league))) - 1


def test_claim_and_notes_tell_agents_apart(tmp_path: Path) -> None:
    league = league_of(Results(tmp_path), OURS, THEIRS)
    ours, theirs = league.rows
    entry = replace(theirs.entry, rival=Rival("dqn", 3600.0))
    plan = replace(league.plan, entries=(ours.entry, entry))
    agents = replace(league, plan=plan, rows=(ours, replace(theirs, entry=entry)))
    assert claim_table(agents).rows == ()
    assert success_table(agents).rows[1][1] == "DQN, 1 h of robot life"
    assert "Agents have the defaults of their libraries" in success_table(agents).note
    assert machine_table(agents).rows[1][2:4] == ("0.50", "3.0")
    for table in (effort_table, machine_table):
        assert "an agent" in table(agents).note.lower()
        assert "an agent" not in table(league).note.lower()


def test_fewest_seconds_in_charge_are_compared(tmp_path: Path) -> None:
    right, stuck = (tuple(robot(seed, *[end] * 3) for seed in (1, 2)) for end in ("right", "stuck"))
    league = league_of(Results(tmp_path), right, right)
    ours, theirs = league.rows

    def claim(seconds: float, outcomes: tuple[RivalOutcome, ...]) -> tuple[str, ...]:
        driven = tuple(each.model_copy(update={"driven_s": seconds}) for each in outcomes)
        held = replace(theirs, entry=replace(theirs.entry, rival=Rival("hg-dagger")), outcomes=driven)
        return hands_table(replace(league, rows=(ours, held))).rows[0]

    assert claim(17.0, right) == ("wall_following", "6", "HG-DAgger", "17", "2.8", "refuted")
    assert claim(18.0, right)[4:] == ("3.0", "stands")
    assert claim(1.0, stuck) == ("wall_following", "6", "none", "-", "-", "stands")
    assert hands_table(league).rows[0][2] == "none"  # 1-NN is not driven by hand
    assert hands_table(league_of(Results(tmp_path), stuck, right)).rows[0][2:] == ("-", "-", "-", "not judged")


def test_comparison_is_paired_by_robot(tmp_path: Path) -> None:
    table = comparison_table(league_of(Results(tmp_path), OURS, THEIRS))
    assert table.rows == (("wall_following", "1-NN without R", "2", "0", "0.500", "0.500", "0.0 (0.0 to 0.0)"),)


def test_presses_are_compared_robot_by_robot(tmp_path: Path) -> None:
    more = tuple(each.model_copy(update={"presses": 8 + each.seed}) for each in OURS)
    (row,) = comparison_table(league_of(Results(tmp_path), more, OURS)).rows
    assert row[-1] == "2.0 (-0.5 to 4.5)"  # 1, 2 and 3 presses: Student's 4.303 / sqrt(3) about 2
    assert comparison_table(league_of(Results(tmp_path), OURS[:1], OURS[:1])).rows[0][-1] == "-"


def test_effort_tells_collisions_of_all_robots(tmp_path: Path) -> None:
    ours, theirs = effort_table(league_of(Results(tmp_path), OURS, THEIRS)).rows
    assert ours[2:] == ("8", "5", "3", "30", "6", "9", "0", "0", "0")
    assert theirs[-3] == "3"


def test_machine_leaves_times_of_a_learner_out_for_rlas(tmp_path: Path) -> None:
    ours, theirs = machine_table(league_of(Results(tmp_path), OURS, THEIRS)).rows
    assert ours[2:] == ("", "", "0.80", "5", "2.0", "3 of 3", "1 (4)", "97%")
    assert theirs[2:4] == ("0.50", "3.0")


def test_failures_have_a_table_only_if_there_are_any(tmp_path: Path) -> None:
    *_, failures = all_tables(league_of(Results(tmp_path), OURS, THEIRS))
    assert failures.rows == (("wall_following", "1-NN without R", "2", "1-nn: ValueError: empty"),)
    assert len(list(all_tables(league_of(Results(tmp_path), OURS, OURS)))) == 5


def test_report_says_which_rivals_were_tuned(tmp_path: Path) -> None:
    league = league_of(Results(tmp_path), OURS, THEIRS)
    (section,) = sections = make_sections(league, tmp_path)
    assert imread(section.picture.path).shape[1] > 500
    page = tmp_path / report_name(sections)
    write_report(league.plan, sections, overview_tables(league, sections), ["3 robots only"], "kurt2rt rivals", page)
    assert page.name == "report.html"
    text = page.read_text(encoding="utf-8")
    assert "with the defaults of their classes: 1-NN without R" in text
    assert "3 robots only" in text
    assert "All learners in short" not in text


def test_page_of_all_leagues_has_a_section_for_each(tmp_path: Path) -> None:
    league = league_of(Results(tmp_path), OURS, THEIRS)
    ours, theirs = league.rows
    others = [replace(theirs, entry=replace(theirs.entry, rival=Rival(name))) for name in ("hg-dagger", "tamer")]
    league = replace(league, rows=(ours, theirs, *others))
    sections = make_sections(league, tmp_path)
    assert [[row.entry.rival.name for row in each.league.rows] for each in sections] == [
        ["rla", "1-nn"],
        ["rla", "hg-dagger"],
        ["rla", "tamer"],
    ]
    page = tmp_path / report_name(sections)
    write_report(league.plan, sections, overview_tables(league, sections), [], "kurt2rt rivals", page)
    assert page.name == "all-report.html"
    assert {each.name for each in tmp_path.glob("*.png")} == {"rivals.png", "holds-rivals.png", "signals-rivals.png"}
    text = page.read_text(encoding="utf-8")
    assert text.count("<img ") == 3
    assert (
        text.index("All learners in short") < text.index("<h2>Taught by presses") < text.index("<h2>Taught by rewards")
    )


def test_claim_about_seconds_stands_in_its_section_alone(tmp_path: Path) -> None:
    league = league_of(Results(tmp_path), OURS, THEIRS)
    ours, theirs = league.rows
    rows = (ours, theirs, replace(theirs, entry=replace(theirs.entry, rival=Rival("hg-dagger"))))
    plan = replace(league.plan, entries=tuple(row.entry for row in rows))
    sections = make_sections(replace(league, plan=plan, rows=rows), tmp_path)
    claims = [[table.title for table in each.tables if "driven by hand" in table.title] for each in sections]
    assert list(map(len, claims)) == [0, 1]


def test_overview_has_one_row_for_each_learner(tmp_path: Path) -> None:
    ours, theirs = overview_table(league_of(Results(tmp_path), OURS, THEIRS)).rows
    assert ours[:3] == ("wall_following", "RLA, as shipped", "presses")
    assert [cell.partition(" (")[0] for cell in (ours[3], theirs[3])] == ["2 of 2", "1 of 3"]
    assert theirs[4:] == ("8", "6", "30", "3", "3 of 3", "0.500")
    assert ours[-1] == ""


def test_all_leagues_share_the_shipped_system() -> None:
    every = [rows_of_league(name) for name in TITLES]
    assert rows_of_league(LeagueName.ALL).count(SHIPPED) == 1
    assert set(rows_of_league(LeagueName.ALL)) == set().union(*every)
    assert all(
        league_of_rival(Rival(row)) is name for name, rows in zip(TITLES, every, strict=True) for row in rows[1:]
    )
