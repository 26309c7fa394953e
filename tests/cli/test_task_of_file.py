"""The task comes from the knowledge file; a task that contradicts the file is refused in one line."""

from dataclasses import replace
from pathlib import Path

import pytest

from kurt2rt import Knowledge
from kurt2rt.core.task_settings import load_task
from kurt2rt.knowledge.exchange.archive import pack, unpack
from kurt2rt.knowledge.journal.journal import Journal
from kurt2rt.knowledge.journal.loading import binding_for
from kurt2rt.knowledge.knowledge_code import KnowledgeCode
from kurt2rt.knowledge.knowledge_error import KnowledgeError
from tests.cli.helpers import CommandLine
from tests.cli.test_bad_input import changed
from tests.experiments.helpers import ROBOT
from tests.knowledge.lessons import begun
from tests.plugin_packages import install

FLEEING = binding_for(ROBOT, load_task("fleeing"))


@pytest.fixture
def fleeing(tmp_path: Path) -> Path:
    """Make a knowledge file of the task fleeing without lessons."""
    path = tmp_path / "mine.knowledge"
    Journal.open(path, FLEEING).close()
    return path


def test_lesson_takes_the_task_of_the_file(kurt2rt: CommandLine, fleeing: Path) -> None:
    short = ("--set", "teaching.supervised_s=1", "--set", "teaching.corrections_s=1")
    said = kurt2rt("train", "--knowledge", fleeing, *short, "--out", "made")
    assert said.exit_code == 0, said.err
    assert said.out.startswith("Lesson: fleeing ")


@pytest.mark.parametrize(
    "words",
    [
        ("exam", "mine.knowledge"),
        ("train", "--knowledge", "mine.knowledge"),
        ("run", "--knowledge", "mine.knowledge"),
        ("knowledge", "export", "mine.knowledge", "--out", "out.zip"),
    ],
    ids=" ".join,
)
@pytest.mark.usefixtures("fleeing")
def test_task_that_contradicts_the_file_is_refused(kurt2rt: CommandLine, words: tuple[str, ...]) -> None:
    error = KnowledgeError(KnowledgeCode.OTHER_TASK_GIVEN, where="mine.knowledge", taught="fleeing", wanted="circle")
    assert kurt2rt.refused(*words, "--task", "circle") == f"kurt2rt: {error}"


TO_READ_IT = (
    ("exam", "mine.knowledge"),
    ("run", "--knowledge", "mine.knowledge"),
    ("train", "--knowledge", "mine.knowledge"),
    ("study", "certify", "mine.knowledge"),
    ("knowledge", "export", "mine.knowledge", "--out", "out.zip"),
    ("knowledge", "contradictions", "mine.knowledge"),
)
"""Commands that look up the task that a knowledge file names."""


def test_own_tasks_file_is_used_with_the_settings_given(kurt2rt: CommandLine, tmp_path: Path) -> None:
    task = changed("tasks", "fleeing", tmp_path, lambda content: content.update(name="sneaking"))
    Journal.open(tmp_path / "mine.knowledge", binding_for(ROBOT, load_task(str(task)))).close()
    for words in TO_READ_IT:
        refusal = kurt2rt.refused(*words)
        assert "mine.knowledge: was taught for the task 'sneaking', which is neither shipped nor installed" in refusal
        assert refusal.endswith("; give its settings yourself: --task PATH.yaml (in Python: task=PATH)")
    short = ("--set", "exam.duration_s=1", "--world", "a")
    assert kurt2rt("exam", "mine.knowledge", "--task", task, *short).exit_code == 0
    assert kurt2rt("knowledge", "export", "mine.knowledge", "--out", "out.zip", "--task", task).exit_code == 0
    assert "--task PATH.yaml" in kurt2rt.refused("knowledge", "import", "out.zip", "--out", "theirs.knowledge")
    assert kurt2rt("knowledge", "import", "out.zip", "--out", "theirs.knowledge", "--task", task).exit_code == 0
    assert Knowledge.load("theirs.knowledge", task=str(task)).lessons == 0
    runtime = changed("runtime", "default", tmp_path, lambda content: content.update(task=str(task)))
    short_run = ("run", "--seconds", "0.1", "--port", "0", "--no-record", "--knowledge", "theirs.knowledge")
    said = kurt2rt(*short_run, "--settings", runtime)
    assert said.out.startswith("task sneaking")


def test_graphml_of_an_unknown_task_is_written(kurt2rt: CommandLine, tmp_path: Path) -> None:
    begun(tmp_path / "mine.knowledge")  # of a task that is not installed
    words = ("knowledge", "graph", "mine.knowledge", "--out")
    said = kurt2rt(*words, "net.graphml")
    assert (said.exit_code, said.err) == (0, "")
    assert (tmp_path / "net.graphml").is_file()
    assert "neither shipped nor installed" in kurt2rt.refused(*words, "net.svg")


@pytest.mark.parametrize("named", ["evil:TASK", "./evil.yaml", "evil"])
def test_strangers_file_runs_no_code_by_a_name_in_it(kurt2rt: CommandLine, plugin_folder: Path, named: str) -> None:
    (plugin_folder / "evil.py").write_text("open('owned', 'x')\n")
    policy = {"kind": "evil:PolicySettings"}
    task = changed("tasks", "fleeing", plugin_folder, lambda content: content.update(policy=policy))
    task.rename(plugin_folder / "evil.yaml")
    named = str(plugin_folder / named) if named == "evil" else named
    Journal.open(plugin_folder / "mine.knowledge", replace(FLEEING, system=named)).close()
    Journal.open(plugin_folder / "good.knowledge", FLEEING).close()
    said = [kurt2rt.refused(*words) for words in TO_READ_IT]
    assert kurt2rt("knowledge", "export", "good.knowledge", "--out", "good.zip").exit_code == 0
    good = unpack(plugin_folder / "good.zip")
    about = {name: value for name, value in good.manifest.items() if name not in ("format", "files")}
    (plugin_folder / "evil.zip").write_bytes(pack({**about, "task": named}, good.files))
    said.append(kurt2rt.refused("knowledge", "import", "evil.zip", "--out", "k"))
    with pytest.raises(KnowledgeError) as refused:
        Knowledge.load("mine.knowledge")
    assert [each for each in (*said, str(refused.value)) if "which is neither shipped nor installed" not in each] == []
    assert not (plugin_folder / "owned").exists()


@pytest.mark.parametrize(
    ("typed", "offered"),
    [
        ("kurt2rt exam x --task wal", "wall_following"),
        ("kurt2rt exam x --task stro", "strolling"),
        ("kurt2rt run --world manh", "manhattan"),
        ("kurt2rt train --task school/fl", "school/fleeing"),
    ],
)
def test_completion_offers_shipped_and_installed_names(
    kurt2rt: CommandLine, plugin_folder: Path, monkeypatch: pytest.MonkeyPatch, typed: str, offered: str
) -> None:
    install(plugin_folder, "ours", {"tasks": {"strolling": "tasks_b:TASK"}})
    monkeypatch.setenv("_KURT2RT_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", typed)
    monkeypatch.setenv("COMP_CWORD", str(len(typed.split()) - 1))
    assert kurt2rt().out.split() == [offered]
