"""`--shard` and `kurt2rt results` as a user meets them."""

import json
import re
import shlex
import shutil
from pathlib import Path

import pytest

from tests.cli.helpers import ROOT, CommandLine

SHORT = (
    *("--set", "teaching.supervised_s=2", "--set", "teaching.corrections_s=1", "--set", "exam.duration_s=1"),
    *("--set", "exam.worlds=[a]", "--jobs", "1"),
)
LESSON = ("lesson", "--seeds", "3,5,8", *SHORT)


def documented() -> list[tuple[str, ...]]:
    """Return the commands of the handbook's block about shards, with few robots and short lessons."""
    text = (ROOT / "docs/handbook.md").read_text(encoding="utf-8")
    (block,) = re.findall(r"^```\n((?:kurt2rt .*\n)*kurt2rt .*--shard.*\n(?:kurt2rt .*\n)*)```$", text, re.MULTILINE)
    typed = [tuple(shlex.split(line)[1:]) for line in block.replace("100-119", "100,101").splitlines()]
    return [(*words, *SHORT) if words[0] == "lesson" else words for words in typed]


def test_documented_shards_merge_to_what_one_machine_does(kurt2rt: CommandLine) -> None:
    commands = documented()
    *_, last = [kurt2rt(*words) for words in commands]
    assert last.exit_code == 0, last.err
    whole = kurt2rt(*commands[-1][:-1], "1", "--out", "alone")
    assert last.out == whole.out
    made = sorted(path.relative_to("alone") for path in Path("alone").rglob("*") if path.is_file())
    assert made == sorted(path.relative_to("results/all") for path in Path("results/all").rglob("*") if path.is_file())
    for path in made:
        if path.suffix == ".json":
            assert (Path("alone") / path).read_bytes() == (Path("results/all") / path).read_bytes()


def test_shard_says_what_comes_next_and_judges_nothing(kurt2rt: CommandLine) -> None:
    said = kurt2rt(*LESSON, "--shard", "1/2", "--out", "made")
    assert said.exit_code == 0, said.err
    done, following = said.out.splitlines()
    assert done == "shard 1/2 is done: 2 jobs in made"
    assert following.startswith("next: ")
    assert "kurt2rt results merge OUT made ..." in following
    assert {path.name for path in Path("made").glob("*.knowledge")} == {f"wall_following-{n}.knowledge" for n in (3, 8)}
    as_data = json.loads(kurt2rt(*LESSON, "--shard", "1/2", "--out", "made", "--json").out)
    assert as_data == {"shard": "1/2", "seeds": [3, 8], "jobs": 2, "folder": "made"}


def test_results_show_names_what_is_missing(kurt2rt: CommandLine) -> None:
    kurt2rt(*LESSON, "--shard", "1/2", "--out", "made")
    said = kurt2rt("results", "show", "made")
    assert said.exit_code == 0, said.err
    assert "2 of 3" in said.out
    assert "wall_following, seed 5" in said.out
    assert "next:" not in said.out
    (study,) = json.loads(kurt2rt("results", "show", "made", "--json").out)["studies"]
    assert study["command"].startswith("kurt2rt lesson --task wall_following --set teaching.supervised_s=2 ")
    assert study["command"].endswith(" --seeds 3,5,8")
    assert (study["jobs"], study["missing"]) == (3, ["wall_following, seed 5"])
    assert len(study["sources"]) == 1


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (("paper", "--quick", "--shard", "3/3"), "got 3, allowed 2"),
        (("lesson", "--seeds", "1,2", "--shard", "2"), "'2', allowed K/N"),
        (("transfer", "--seeds", "1100", "--shard", "0/2"), "'0/2', allowed K/N"),
        (("results", "show", "."), "holds no study"),
        (("results", "merge", "out", "."), "holds no study"),
    ],
)
def test_shard_or_part_that_is_none_is_refused(kurt2rt: CommandLine, words: tuple[str, ...], told: str) -> None:
    assert told in kurt2rt.refused(*words)
    assert not Path("results").exists()
    assert not Path("out").exists()


def test_shard_of_one_robot_is_refused(kurt2rt: CommandLine) -> None:
    assert "give --seeds" in kurt2rt.misused("lesson", "--shard", "1/2")


def test_merge_refuses_shards_of_other_settings(kurt2rt: CommandLine) -> None:
    kurt2rt(*LESSON, "--shard", "1/2", "--out", "one")
    kurt2rt(*LESSON, "--set", "learning.radius=700", "--shard", "2/2", "--out", "two")
    line = kurt2rt.refused("results", "merge", "both", "one", "two")
    assert line.startswith("kurt2rt: two: results/wall_following-3.json was made with other task than in one (got ")
    shutil.copytree("one", "three")
    said = kurt2rt("results", "merge", "both", "one", "three", "--json")
    assert said.exit_code == 0, said.err
    assert [(part["results"], part["copied"]) for part in json.loads(said.out)["parts"]] == [(2, 2), (2, 0)]
