"""`kurt2rt rivals` as a user meets it."""

import json
from pathlib import Path

from tests.cli.helpers import CommandLine

SHORT = (
    *("--set", "teaching.supervised_s=3", "--set", "teaching.corrections_s=2", "--set", "exam.duration_s=2"),
    *("--set", "exam.worlds=[a]", "--seeds", "3904", "--after", "1", "--jobs", "1", "--out", "made"),
)
BROKEN = """
class Never:
    def __init__(self, setting):
        self.setting = setting

    def decide(self, situation, *, taught):
        return None

    def lesson(self, situation, action, why):
        pass

    def snapshot(self):
        return b""

    def restore(self, data):
        pass
"""


def test_rivals_are_taught_once_and_reported(kurt2rt: CommandLine) -> None:
    words = ("rivals", "--learner", "k-nn", *SHORT)
    said = kurt2rt(*words, "--json")
    assert said.exit_code == 0, said.err
    document = json.loads(said.out)
    assert set(document) == {"tables", "not_judged", "report"}
    assert [row[1] for row in document["tables"][0]["rows"]] == ["RLA, as shipped", "5-NN with R"]
    assert Path(document["report"]).is_file()
    kept = Path("made/results/k-nn/wall_following-3904.json")
    before = kept.stat().st_mtime_ns
    said = kurt2rt(*words)
    assert said.exit_code == 0, said.err
    assert "5-NN with R" in said.out
    assert kept.stat().st_mtime_ns == before


def test_check_names_broken_promises_and_fails(kurt2rt: CommandLine) -> None:
    Path("my_never.py").write_text(BROKEN, encoding="utf-8")
    said = kurt2rt("rivals", "--learner", "my_never:Never", "--learner", "k-nn", "--check")
    assert said.exit_code == 1
    *lines, note = said.out.splitlines()
    assert lines == [
        "my_never:Never: breaks promises",
        "  `decide` follows the first lesson in its situation: it does not",
        "k-nn: keeps all promises",
    ]
    assert note.startswith("  decide takes 0.")
    assert not Path("results").exists()


def test_learner_of_ones_own_stands_with_a_league(kurt2rt: CommandLine) -> None:
    said = kurt2rt("rivals", "--league", "signals", "--learner", "k-nn", "--learner", "tamer", "--check", "--json")
    assert said.exit_code == 0, said.err
    names = list(json.loads(said.out)["broken"])
    assert names[-1] == "k-nn"
    assert names.count("tamer") == 1
    assert "coach" in names


def test_leagues_on_one_page_say_which_table_is_whose(kurt2rt: CommandLine) -> None:
    words = ("rivals", "--learner", "k-nn", "--learner", "tamer", *SHORT)
    said = kurt2rt(*words, "--json")
    assert said.exit_code == 0, said.err
    document = json.loads(said.out)
    overview, *tables = document["tables"]
    assert [row[2] for row in overview["rows"]] == ["presses", "presses", "rewards"]
    assert {table["league"] for table in tables} == {"presses", "signals"}
    assert Path(document["report"]).name == "all-report.html"
    shown = kurt2rt(*words).out
    assert shown.index("All learners in short") < shown.index("Taught by presses") < shown.index("Taught by rewards")


def test_unknown_learner_is_refused(kurt2rt: CommandLine) -> None:
    assert "there is no such learner" in kurt2rt.refused("rivals", "--learner", "deep-thought", *SHORT)
    assert not Path("made").exists()


def test_changed_helper_of_a_learner_is_named_as_the_difference(kurt2rt: CommandLine) -> None:
    Path("my_asking.py").write_text(f"import my_helper\n{BROKEN}", encoding="utf-8")
    Path("my_helper.py").write_text("HERE = 1\n", encoding="utf-8")
    words = ("rivals", "--learner", "my_asking:Never", *SHORT)
    assert kurt2rt(*words).exit_code == 0
    Path("my_helper.py").write_text("HERE = 2\n", encoding="utf-8")
    refused = kurt2rt.refused(*words)
    assert "my_asking.Never" in refused
    assert "(what differs: learner)" in refused
